// ball.h - the ball about the origin of the object's own coordinates (paper, tables 2-4, 8.2, 9.6, 10.6).
// Coordinates on it: those of a globe, for the direction at the centre of the shortest geodesic from there.
#ifdef COSTLY_DISTANCE
// In nil, sl2 and sol the distance from o has to be solved for; it lies between two bounds that cost much less than itself.
typedef struct { real below, above; } bounds;

// What ball_twisted.h and ball_sol.h give: the bounds, the closer the nearer to the sphere; and the distance itself.
FN bounds ball_bounds(point q, real radius);
FN real solved_distance(point q, mask *unsolved);

// Bounds are near enough when the nearer one is half of the way to the surface, or when they differ by rounding alone.
#define SQUEEZE_ROUNDING 16

FN mask too_wide(bounds b, real radius)
{
  real way = fmax(b.below - radius, radius - b.above);
  return b.above - b.below > fmax(way, REAL(SQUEEZE_ROUNDING * EPSILON) * b.above);
}

FN real ball_distance(point q, real radius)
{
  bounds b = ball_bounds(q, radius);
  mask open = too_wide(b, radius);
  if (ANY(open)) {
    mask unsolved;
    real solved = solved_distance(select_4(open, q, origin()), &unsolved);
    open &= NOT(unsolved);
    b.below = SELECT(open, solved, b.below);
    b.above = SELECT(open, solved, b.above);
  }
  real distance = SELECT(b.above < radius, b.above, b.below) - radius, sum = q.x + q.y + q.z + q.w;
  // fmin and fmax forget a NaN.
  return SELECT(sum == sum, distance, sum);
}

// Where the geodesic from the centre is looked for: farther than anything that counts as a hit.
#define BALL_SEEN_BELOW C(0.1)

FN surface ball_surface(point q, real radius)
{
  point exact = {REAL(0), REAL(0), REAL(0), REAL(0)};
  real distance = ball_distance(q, radius);
  mask seen = fabs(distance) < REAL(BALL_SEEN_BELOW);
  direction u = {REAL(0), REAL(0), REAL(1)}, arriving = u;
  if (ANY(seen)) {
    connection c = connect_points(origin(), select_4(seen, q, origin()), exact, exact, 0);
    u = arriving = c.u;
    exponential(&arriving, c.length, REAL(0));
    // Where the solver reached its bound there is no normal, and the pixel is counted.
    arriving.x = SELECT(seen & c.unsolved, REAL(NAN), arriving.x);
  }
  // Spheres cross the geodesics from their centre at right angles (Gauss' lemma).
  return on_globe(distance, with_w(arriving, REAL(0)), u, across_of(u));
}

#elif HOMOGENEOUS == 5
// The distance from o in the factor, and that over its sine, 1 at o. Where S2 is farthest away the quotient stays finite, and
// large enough for the frame there (s2xe.h).
FN real arc_over_sine(point q, real *arc)
{
  real sine = sqrt(fma(q.x, q.x, q.y * q.y));
#if CURVATURE == 1
  sine = fmax(sine, REAL(ANTIPODE_OFFSET));
  *arc = arc_tangent_2(sine, q.z);
#else
  sine = fmax(sine, REAL(TINY));
  *arc = arc_of_sine(sine);
#endif
  return *arc / sine;
}

FN real ball_distance(point q, real radius) { return origin_distance(q) - radius; }

FN surface ball_surface(point q, real radius)
{
  // Half the gradient of the squared distance.
  real arc, ratio = arc_over_sine(q, &arc);
  covector gradient = {REAL(0), REAL(0), REAL(-CURVATURE) * ratio, q.w};
  direction at_centre = {q.x, q.y, q.w};
  return on_globe(ball_distance(q, radius), gradient, at_centre, arc);
}

#else
FN real ball_distance(point q, real radius) { return origin_distance(q) - radius; }

FN surface ball_surface(point q, real radius)
{
#if CURVATURE == 0
  covector gradient = {q.x, q.y, q.z, REAL(0)};
#else
  // Of -<o, q>, which grows with the distance all the way; |x| falls again past the equator of s3.
  covector gradient = {REAL(0), REAL(0), REAL(0), REAL(-CURVATURE)};
#endif
  return on_globe(ball_distance(q, radius), gradient, first_3(q), across_of(first_3(q)));
}
#endif
