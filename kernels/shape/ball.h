// ball.h - the ball about the origin of the object's own coordinates (paper, tables 2-4).
// Coordinates on it: longitude in turns, latitude in half turns, both from 0 to 1.
FN real ball_distance(point q, real radius) { return origin_distance(q) - radius; }

FN surface ball_surface(point q, real radius)
{
  real across = sqrt(fma(q.x, q.x, q.y * q.y));
#if CURVATURE == 0
  covector gradient = {q.x, q.y, q.z, REAL(0)};
#else
  // Of -<o, q>, which grows with the distance all the way; |x| falls again past the equator of s3.
  covector gradient = {REAL(0), REAL(0), REAL(0), REAL(-CURVATURE)};
#endif
  surface s = {ball_distance(q, radius), gradient,
               fma(arc_tangent_2(q.y, q.x), REAL(C(0.15915494309189535)), REAL(C(0.5))),
               fma(arc_tangent_2(q.z, across), REAL(C(0.31830988618379067)), REAL(C(0.5)))};
  return s;
}
