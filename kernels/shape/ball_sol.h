// ball_sol.h - sol: how far the ball of ball.h is at least and at most (in place of the pseudo-ball of paper 11.5).
//
// With f the underestimate, X^2 = e^-z x^2 and Y^2 = e^z y^2,
//     d^2 = f^2 + X^2 Y^2 ((X^2 + Y^2)/120 + z^2/180)/(1 + k (X^2 + Y^2 + 7 z^2)).
// The numerator is the first term of the power series of d^2 - f^2 (fitted); k > 0.122, and k < 0.303 where d < 1.5 (measured at three
// million points). There the bounds of d differ by less than d^7/4000: the solver is asked where d < 0.5 only within 2e-6 of the
// surface, at d = 1 within 2e-4, at d = 3 within 0.1.
#define LEAST_FADING C(0.12)
#define MOST_FADING C(0.31)
#define FADING_KNOWN_BELOW C(1.4)

FN bounds ball_bounds(point q, real radius)
{
  real f = underestimate(q), stretch = exp(q.z), height = q.z * q.z, a = q.x * q.x / stretch, b = q.y * q.y * stretch, sum = a + b;
  real more = a * b * fma(sum, REAL(C(0.0083333333333333333)), height * REAL(C(0.0055555555555555556))), size = fma(REAL(7), height, sum);
  real least = SELECT(f < REAL(FADING_KNOWN_BELOW), more / fma(REAL(MOST_FADING), size, REAL(1)), REAL(0));
  real most = more / fma(REAL(LEAST_FADING), size, REAL(1));
  bounds r = {sqrt(fma(f, f, least)), fmin(sqrt(fma(f, f, most)), overestimate(q))};
  return r;
}

FN real solved_distance(point q, mask *unsolved)
{
  connection shortest = connect(q.x, q.y, q.z, 0, REAL(LENGTH_TOLERANCE));
  *unsolved = shortest.unsolved;
  return shortest.length;
}
