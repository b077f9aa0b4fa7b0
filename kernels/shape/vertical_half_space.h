// vertical_half_space.h - fibred geometries: the part x <= 0 of the object's own coordinates, bounded by all fibres over the
// y-line of the base. The distance is that in the base (paper 8.2, 9.4, 10.4); the boundary is flat, and totally geodesic in
// the products alone.
// Coordinates on it: length along the y-line, fibre coordinate; squares of both are Euclidean squares (paper, figures 42, 52).
FN real vertical_half_space_distance(point q)
{
#if defined(COSTLY_DISTANCE) && HOMOGENEOUS == 4
  return q.x;
#elif defined(COSTLY_DISTANCE)
  return area_sinh_odd(q.x);
#elif CURVATURE == 1
  // The sine says little near the poles, a quarter turn away.
  return arc_tangent_2(q.x, sqrt(fma(q.y, q.y, q.z * q.z)));
#else
  return arc_of_sine(q.x);
#endif
}

FN surface vertical_half_space_surface(point q)
{
#if defined(COSTLY_DISTANCE) && HOMOGENEOUS == 4
  real along = q.y, up = q.z;
#elif defined(COSTLY_DISTANCE)
  real sine = q.y * rsqrt(fma(q.x, q.x, REAL(1))), along = area_sinh_odd(sine), up = q.w;
#else
  real along = axis_length(q.y, q.x * q.x, q.z), up = q.w;
#endif
  covector x = {REAL(1), REAL(0), REAL(0), REAL(0)};
  surface s = {vertical_half_space_distance(q), gradient_of(q, x), along, up};
  return s;
}
