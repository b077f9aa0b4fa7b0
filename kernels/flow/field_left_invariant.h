// field_left_invariant.h - the geodesic equation of nil and sol as two systems of first order (paper 3.1, 3.2): the direction u in the
// left-invariant frame changes by itself, and moves the point by the derivative of its translation.
FN motion motion_from_origin(direction u)
{
  motion m = {origin(), with_w(u, REAL(0))};
  return m;
}
FN motion rate_of(motion m)
{
  direction u = first_3(m.along);
  motion r = {velocity(m.at, u), with_w(acceleration(u), REAL(0))};
  return r;
}
// Integrators let |u| grow or fall, and time with it: it is put back after each step.
FN motion kept(motion m)
{
  m.along = scale_4(m.along, rsqrt(dot_4(m.along, m.along)));
  return m;
}
FN real turns_between(motion before, motion after) { return REAL(0); }
FN point reached_by(motion m, real turns, direction *u)
{
  *u = first_3(m.along);
  return m.at;
}
