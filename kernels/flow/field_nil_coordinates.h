// field_nil_coordinates.h - the geodesic equation of nil in the coordinates x, y, z, of second order: what the paper's tables A1 and A2
// were made with. With the momentum c = z' - (x y' - y x')/2, which stays: x'' = -c y', y'' = c x', z'' = c (x x' + y y')/2.
FN motion motion_from_origin(direction u)
{
  motion m = {origin(), with_w(u, REAL(0))};
  return m;
}
FN motion rate_of(motion m)
{
  point p = m.at;
  vector v = m.along;
  real c = v.z - twist(p.x, p.y, v.x, v.y);
  vector bend = {-c * v.y, c * v.x, REAL(C(0.5)) * c * fma(p.x, v.x, p.y * v.y), REAL(0)};
  motion r = {v, bend};
  return r;
}
FN motion kept(motion m) { return m; }
FN real turns_between(motion before, motion after) { return REAL(0); }
FN point reached_by(motion m, real turns, direction *u)
{
  direction d = {m.along.x, m.along.y, m.along.z - twist(m.at.x, m.at.y, m.along.x, m.along.y)};
  *u = d;
  return m.at;
}
