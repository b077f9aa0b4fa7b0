// level_cylinder.h - s2xe, h2xe: the solid cylinder about the x-geodesic of the object's own coordinates, whose flat strips
// over lines of the base are its plane sections (paper, table 2).
// Coordinates on it: the angle about the axis in turns, the length along the axis.

// The signed distance from the x-geodesic in the factor; *cosine is its cosine.
FN real distance_from_x_line(point q, real *cosine)
{
#if CURVATURE == 1
  *cosine = sqrt(fma(q.x, q.x, q.z * q.z));
  return arc_tangent_2(q.y, *cosine);
#else
  *cosine = sqrt(fma(q.y, q.y, REAL(1)));
  return arc_of_sine(q.y);
#endif
}

FN real level_cylinder_distance(point q, real radius)
{
  real cosine, beside = distance_from_x_line(q, &cosine);
  return hypotenuse(beside, q.w) - radius;
}

FN surface level_cylinder_surface(point q, real radius)
{
  real cosine, beside = distance_from_x_line(q, &cosine);
  // Half the gradient of the squared distance, times the cosine.
  covector gradient = {REAL(0), beside, REAL(0), q.w * cosine};
  surface s = {hypotenuse(beside, q.w) - radius, gradient,
               turns(q.w, beside),
               axis_length(q.x, q.y * q.y, q.z)};
  return s;
}
