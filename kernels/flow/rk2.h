// rk2.h - one step of the midpoint rule, of order 2.
FN motion step_of(motion y, real h)
{
  motion middle = add_motion(y, rate_of(y), REAL(C(0.5)) * h);
  return add_motion(y, rate_of(middle), h);
}
