// rk8.h - one step of Cooper and Verner's rule, of order 8 (SIAM J. Numer. Anal. 9, 1972): eleven evaluations, the fewest that order 8
// can have, and rational in the root of 21, so that the table can be read. An order as high comes down to the rounding of double precision
// with steps of a tenth, where order 4 would take hundreds of times as many.
#define ROOT_21 C(4.58257569495584000659)
#define STAGES 11
FN motion step_of(motion y, real h)
{
  // The rows of the table; each evaluation is at y and so much of those before it. The last row is the step itself.
  const scalar weight[STAGES][STAGES] = {
      {C(0.5)},
      {C(0.25), C(0.25)},
      {C(1.) / 7, (-7 - 3 * ROOT_21) / 98, (21 + 5 * ROOT_21) / 49},
      {(11 + ROOT_21) / 84, 0, (18 + 4 * ROOT_21) / 63, (21 - ROOT_21) / 252},
      {(5 + ROOT_21) / 48, 0, (9 + ROOT_21) / 36, (-231 + 14 * ROOT_21) / 360, (63 - 7 * ROOT_21) / 80},
      {(10 - ROOT_21) / 42, 0, (-432 + 92 * ROOT_21) / 315, (633 - 145 * ROOT_21) / 90, (-504 + 115 * ROOT_21) / 70,
       (63 - 13 * ROOT_21) / 35},
      {C(1.) / 14, 0, 0, 0, (14 - 3 * ROOT_21) / 126, (13 - 3 * ROOT_21) / 63, C(1.) / 9},
      {C(1.) / 32, 0, 0, 0, (91 - 21 * ROOT_21) / 576, C(11.) / 72, (-385 - 75 * ROOT_21) / 1152, (63 + 13 * ROOT_21) / 128},
      {C(1.) / 14, 0, 0, 0, C(1.) / 9, (-733 - 147 * ROOT_21) / 2205, (515 + 111 * ROOT_21) / 504, (-51 - 11 * ROOT_21) / 56,
       (132 + 28 * ROOT_21) / 245},
      {0, 0, 0, 0, (-42 + 7 * ROOT_21) / 18, (-18 + 28 * ROOT_21) / 45, (-273 - 53 * ROOT_21) / 72, (301 + 53 * ROOT_21) / 72,
       (28 - 28 * ROOT_21) / 45, (49 - 7 * ROOT_21) / 18},
      {C(0.05), 0, 0, 0, 0, 0, 0, C(49.) / 180, C(16.) / 45, C(49.) / 180, C(0.05)},
  };
  motion rate[STAGES], at = y;
#pragma unroll
  for (int i = 0; i < STAGES; i++) {
    rate[i] = rate_of(at);
    at = y;
#pragma unroll
    for (int j = 0; j < STAGES; j++)
      if (j <= i && weight[i][j] != 0) at = add_motion(at, rate[j], h * REAL(weight[i][j]));
  }
  return at;
}
