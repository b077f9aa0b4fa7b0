// half_space.h - the half-space z <= 0 of the object's own coordinates, bounded by a totally geodesic plane (paper, tables 2-4).
// Coordinates on the plane: length along the x-geodesic, distance from it.
FN real half_space_distance(point q) { return arc_of_sine(q.z); }

FN surface half_space_surface(point q)
{
  surface s = {half_space_distance(q), {REAL(0), REAL(0), REAL(1), REAL(0)},
               axis_length(q.x, fma(q.y, q.y, q.z * q.z), q.w), arc_of_sine(q.y)};
  return s;
}
