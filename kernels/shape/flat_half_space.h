// flat_half_space.h - sol: the half-space z <= 0 of the object's own coordinates (paper, lemma 11.2). Its boundary is a Euclidean
// plane, and not totally geodesic. Coordinates on it: x and y, which are lengths there (paper, figure 62).
FN real flat_half_space_distance(point q) { return q.z; }

FN surface flat_half_space_surface(point q)
{
  surface s = {q.z, {REAL(0), REAL(0), REAL(1), REAL(0)}, q.x, q.y};
  return s;
}
