// cylinder.h - the solid cylinder about the z-geodesic of the object's own coordinates (paper, tables 2-4).
// Coordinates on it: the angle about the axis in turns, the length along the axis.
FN real cylinder_distance(point q, real radius)
{
  real across = sqrt(fma(q.x, q.x, q.y * q.y));
#if CURVATURE == 1
  // The sine says little near the circle a quarter turn away.
  return arc_tangent_2(across, sqrt(fma(q.z, q.z, q.w * q.w))) - radius;
#else
  return arc_of_sine(across) - radius;
#endif
}

FN surface cylinder_surface(point q, real radius)
{
  surface s = {cylinder_distance(q, radius), {q.x, q.y, REAL(0), REAL(0)},
               fma(arc_tangent_2(q.y, q.x), REAL(C(0.15915494309189535)), REAL(C(0.5))),
               axis_length(q.z, fma(q.x, q.x, q.y * q.y), q.w)};
  return s;
}
