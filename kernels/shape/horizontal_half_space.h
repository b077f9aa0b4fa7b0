// horizontal_half_space.h - fibred geometries: where the fibre coordinate of the object's own coordinates is not positive.
//
// In nil and sl2 no distance is known; along the ray with the vector v it is bounded (paper 12.3): by level_time, which is exact
// in the products. Inside, the negative value bounds the way out. Coordinates on the boundary: nil x and y; elsewhere the
// signed distance from the y-line of the base, which its equidistant curves have alike (paper, figure 56), and the length
// along that line.

// The level of a point, with its gradient.
FN surface horizontal_half_space_surface(point q)
{
#if HOMOGENEOUS == 4
  covector up = {REAL(0), REAL(0), REAL(1), REAL(0)};
  surface s = {q.z, gradient_of(q, up), q.x, q.y};
#else
  covector up = {REAL(0), REAL(0), REAL(0), REAL(1)};
#ifdef COSTLY_DISTANCE
  real sine = q.y * rsqrt(fma(q.x, q.x, REAL(1)));
  real beside = area_sinh_odd(q.x), along = area_sinh_odd(sine);
#else
  real beside = arc_of_sine(q.x), along = axis_length(q.y, q.x * q.x, q.z);
#endif
  surface s = {q.w, gradient_of(q, up), beside, along};
#endif
  return s;
}

// The distance in all directions, to first order: the level by the size of its gradient. Exact in the products.
FN real horizontal_half_space_clearance(point q, vector v)
{
  surface s = horizontal_half_space_surface(q);
  direction g = pull_covector(q, s.gradient);
  return s.distance * rsqrt(dot_3(g, g));
}

FN real horizontal_half_space_distance(point q, vector v)
{
  real level = horizontal_half_space_surface(q).distance, way = fmax(fabs(level), REAL(TINY)), never = REAL(INFINITY);
  mask outside = level > REAL(0), inside = level <= REAL(0);
  real t = level_time(q, v, SELECT(outside, never, way), SELECT(outside, way, never));
  // Where there is no point there is no side either.
  return SELECT(outside, t, SELECT(inside, -t, level));
}
