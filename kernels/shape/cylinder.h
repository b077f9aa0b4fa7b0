// cylinder.h - the solid cylinder about the z-geodesic of the object's own coordinates, in fibred geometries about the fibre:
// there it is the distance in the base (paper, tables 2-4, 8.2, 9.4, 10.4).
// Coordinates on it: the angle about the axis in turns; the length along the axis, or the fibre coordinate.
FN real cylinder_distance(point q, real radius)
{
#if HOMOGENEOUS == 5 && !defined(COSTLY_DISTANCE)
  return factor_origin_distance(factor(q)) - radius;
#else
  real across = sqrt(fma(q.x, q.x, q.y * q.y));
#if HOMOGENEOUS == 5
  return area_sinh(across) - radius;
#elif defined(COSTLY_DISTANCE)
  return across - radius;
#elif CURVATURE == 1
  // The sine says little near the circle a quarter turn away.
  return arc_tangent_2(across, sqrt(fma(q.z, q.z, q.w * q.w))) - radius;
#else
  return arc_of_sine(across) - radius;
#endif
#endif
}

FN surface cylinder_surface(point q, real radius)
{
#if HOMOGENEOUS == 5 && !defined(COSTLY_DISTANCE)
  // Of -<o, q> in the factor; |(x, y)| falls again past the equator of S2.
  covector gradient = {REAL(0), REAL(0), REAL(-CURVATURE), REAL(0)};
#else
  covector gradient = {q.x, q.y, REAL(0), REAL(0)};
#endif
#if HOMOGENEOUS == 5
  real along = q.w;
#elif defined(COSTLY_DISTANCE)
  real along = q.z;
#else
  real along = axis_length(q.z, fma(q.x, q.x, q.y * q.y), q.w);
#endif
  surface s = {cylinder_distance(q, radius), gradient_of(q, gradient),
               turns(q.y, q.x), along};
  return s;
}
