// hyperbolic_half_space.h - sol: the half-space x <= 0 of the object's own coordinates, bounded by a hyperbolic plane, which is totally
// geodesic (paper, lemmas 11.3, 11.4). Coordinates on it: y, the same all along a geodesic parallel to the z-axis, and z, the same all
// along a horocycle across these, in lengths between them (paper, figure 63).
FN real hyperbolic_half_space_distance(point q) { return area_sinh_odd(q.x * exp(-q.z)); }

FN surface hyperbolic_half_space_surface(point q)
{
  surface s = {hyperbolic_half_space_distance(q), {REAL(1), REAL(0), -q.x * exp(-q.z), REAL(0)}, q.y, q.z};
  return s;
}
