// horoball.h - h3: the horoball about the ideal point +z whose boundary passes at the signed distance `offset` from the origin.
// Its distance is the Busemann function log(w - z), +offset. Towards the ideal point w - z cancels; (w - z)(w + z) = 1 + x^2 + y^2.
// Coordinates on it: x and y, which are Euclidean lengths on the horosphere.
FN real horoball_distance(point q, real offset)
{
  mask towards_it = q.z > REAL(0);
  real across = fma(q.x, q.x, fma(q.y, q.y, REAL(1)));
  return log(SELECT(towards_it, across / SELECT(towards_it, q.w + q.z, REAL(1)), q.w - q.z)) + offset;
}

FN surface horoball_surface(point q, real offset)
{
  surface s = {horoball_distance(q, offset), {REAL(0), REAL(0), REAL(-1), REAL(1)}, q.x, q.y};
  return s;
}
