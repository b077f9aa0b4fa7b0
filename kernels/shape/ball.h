// ball.h - the ball about the origin of the object's own coordinates (paper, tables 2-4).
// Coordinates on it: longitude in turns, latitude in half turns, both from 0 to 1.
FN real ball_distance(point q, real radius) { return origin_distance(q) - radius; }

FN surface ball_surface(point q, real radius)
{
  real across = sqrt(fma(q.x, q.x, q.y * q.y));
  surface s = {ball_distance(q, radius), {q.x, q.y, q.z, REAL(0)},
               fma(arc_tangent_2(q.y, q.x), REAL(C(0.15915494309189535)), REAL(C(0.5))),
               fma(arc_tangent_2(q.z, across), REAL(C(0.31830988618379067)), REAL(C(0.5)))};
#if CURVATURE == 1
  // Past the equator |x| falls again, and so would its gradient.
  mask past = q.w < REAL(0);
  covector by_height = {REAL(0), REAL(0), REAL(0), REAL(-1)};
  s.gradient = select_4(past, by_height, s.gradient);
#endif
  return s;
}
