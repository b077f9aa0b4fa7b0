// field_sl2.h - the geodesic equation of sl2 as two systems of first order (paper 3.1, 3.2): the point as a matrix of SL(2, R), in its
// complex form (Z, E) of sl2.h, which the direction u moves by (Z, E)' = (Z, E) (i u_w/2, (u_x + i u_y)/2). What the paper's tables A3
// and A4 were made with.
FN motion motion_from_origin(direction u)
{
  point identity = {REAL(1), REAL(0), REAL(0), REAL(0)};
  motion m = {identity, with_w(u, REAL(0))};
  return m;
}
FN motion rate_of(motion m)
{
  point q = m.at;
  direction u = first_3(m.along), h = scale_3(u, REAL(C(0.5)));
  point moved = {fma(q.z, h.x, fma(q.w, h.y, -q.y * h.z)), fma(q.w, h.x, fma(-q.z, h.y, q.x * h.z)),
                 fma(q.x, h.x, fma(-q.y, h.y, q.w * h.z)), fma(q.x, h.y, fma(q.y, h.x, -q.z * h.z))};
  motion r = {moved, with_w(acceleration(u), REAL(0))};
  return r;
}
// Integrators let |u| grow or fall, and time with it: it is put back after each step, as it must have been for the paper's tables A3 and A4.
FN motion kept(motion m)
{
  m.along = scale_4(m.along, rsqrt(dot_4(m.along, m.along)));
  return m;
}
// Whole turns that arg Z has made: it passes the negative numbers upwards or downwards. No step turns it by a half.
FN real turns_between(motion before, motion after)
{
  mask left = (before.at.x < REAL(0)) & (after.at.x < REAL(0)), was_up = NOT(before.at.y < REAL(0)), is_up = NOT(after.at.y < REAL(0));
  return SELECT(left & was_up & NOT(is_up), REAL(1), SELECT(left & is_up & NOT(was_up), REAL(-1), REAL(0)));
}
// x + i y = 2 Z E; the matrix is put back to determinant 1, and is lost where it has none. The fibre coordinate is 2 arg Z.
FN point reached_by(motion m, real turns, direction *u)
{
  point q = m.at;
  real determinant = fma(q.x, q.x, fma(q.y, q.y, -fma(q.z, q.z, q.w * q.w)));
  real scale = SELECT(determinant > REAL(0), REAL(2) / determinant, REAL(NAN));
  real x = scale * fma(q.x, q.z, -q.y * q.w), y = scale * fma(q.x, q.w, q.y * q.z);
  point p = {x, y, sheet_height(x, y), REAL(2) * fma(turns, REAL(2 * PI_HIGH), arc_tangent_2(q.y + REAL(0), q.x))};
  *u = first_3(m.along);
  return p;
}
