// rk4.h - one step of the classical rule of Runge and Kutta, of order 4.
FN motion step_of(motion y, real h)
{
  real half_h = REAL(C(0.5)) * h;
  motion a = rate_of(y), b = rate_of(add_motion(y, a, half_h)), c = rate_of(add_motion(y, b, half_h)), d = rate_of(add_motion(y, c, h));
  motion middle = add_motion(b, c, REAL(1)), ends = add_motion(a, d, REAL(1));
  return add_motion(y, add_motion(ends, middle, REAL(2)), h * REAL(C(0.16666666666666667)));
}
