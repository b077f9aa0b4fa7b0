// left_invariant.h - what nil, sl2 and sol share: groups with a left-invariant metric (paper 3.2.1, 3.4.1).
//
// Frames are left-invariant, so that a direction is the derivative of a geodesic pulled back to the origin, and left translations
// leave it alone. The distance has to be solved for.
#define COSTLY_DISTANCE

// A translation does not turn frames.
FN direction turn_frame(point base, point reached, direction u) { return u; }

// Vectors and covectors are components in the left-invariant frame.
FN vector push(point p, direction u) { return with_w(u, REAL(0)); }
FN direction pull(point p, vector v) { return first_3(v); }
FN direction pull_covector(point p, covector g) { return first_3(g); }
FN real inner(point p, vector a, vector b) { return dot_3(first_3(a), first_3(b)); }

// What each geometry gives.
FN point translate(point p, point q);
// Inlined or called, as each geometry defines it.
static point exponential(direction *u, real t, real tail);
SOLVER connection connect_points(point p, point q, point p_tail, point q_tail, int index);

FN real distance_between(point p, point q, point p_tail, point q_tail, mask *unsolved)
{
  connection shortest = connect_points(p, q, p_tail, q_tail, 0);
  *unsolved = shortest.unsolved;
  return shortest.length;
}

// The geodesic flow: p and the unit vector v at p move on by the arc length t.
FN void flow(point *p, vector *v, real t)
{
  direction u = first_3(*v);
  point reached = exponential(&u, t, REAL(0));
  *p = translate(*p, reached);
  *v = with_w(u, REAL(0));
}

FN vector unit_speed(vector v) { return scale_4(v, unit_correction(dot_3(first_3(v), first_3(v)))); }
