// e3.h - Euclidean space: the affine space w = 1 of R^4 (paper 7.1), K = 0.
//
// RANGE. In double, squares overflow beyond 1e154 from the origin: the bound of the distance is infinite there, distances are not.
// ACCURACY (maximal relative error, tests/test_golden.py)
//   points, transport               float 2.1e-7   double 3.3e-16
//   distance, down to 1e-9 apart    float 2.5e-7   double 2.2e-16   (direction 1.5e-6 in float)
#define CURVATURE 0
FN real curved_sine(real t, real *cosine) { *cosine = REAL(1); return t; }
FN real arc_of_sine(real s) { return s; }
FN real inverse_one_plus_w(point p) { return REAL(C(0.5)); }
FN real inner(point p, vector a, vector b) { return dot_3(first_3(a), first_3(b)); }
FN real origin_distance(point p) { return sqrt(dot_3(first_3(p), first_3(p))); }

// Length along the axis through o of the foot of a point, from its coordinate z along the axis, the square of those across it,
// and w.
FN real axis_length(real z, real across_square, real w) { return z; }

FN void chord(point p, point q, point p_tail, point q_tail, real4_lanes *d, real4_lanes *sum)
{
  *d = add_scaled_4(add_scaled_4(q, p, REAL(-1)), add_scaled_4(q_tail, p_tail, REAL(-1)), REAL(1));
  *sum = add_scaled_4(q, p, REAL(1));
}

FN real separation(point p, point q, point p_tail, point q_tail)
{
  real4_lanes d, sum;
  chord(p, q, p_tail, q_tail, &d, &sum);
  real back, scale = square_scale(fmax(fmax(fabs(d.x), fabs(d.y)), fabs(d.z)), &back);
  real3_lanes scaled = scale_3(first_3(d), scale);
  return back * sqrt(dot_3(scaled, scaled));
}

// Where q lies from p, in the frame at p, not normalised.
FN direction towards(point p, point q, point p_tail, point q_tail)
{
  real4_lanes d, sum;
  chord(p, q, p_tail, q_tail, &d, &sum);
  return first_3(d);
}

// Time until a wall n is crossed at speed l, from the ratio (n . v)/(-n . p): on a straight line n . p + t n . v = 0.
FN real meeting_time(real ratio, real l) { return straight_meeting(ratio); }

FN real coordinate_size(point p) { return REAL(1) + fmax(fmax(fabs(p.x), fabs(p.y)), fabs(p.z)); }

// A computed point, put back on the model.
FN point on_model(point p) { return p; }

// Rounding of the flow, undone: here only the speed drifts.
FN void reproject(point *p, vector *v) { *v = scale_4(*v, unit_correction(dot_3(first_3(*v), first_3(*v)))); }
