// jacobi.h - Jacobi's elliptic functions and the complete elliptic integrals, by the arithmetic-geometric mean of 1 and k'.
//
//   a_0 = 1, b_0 = k', c_0 = k;  a_i+1 = (a_i + b_i)/2,  b_i+1 = sqrt(a_i b_i),  c_i+1 = c_i^2/(4 a_i+1) = (a_i - b_i)/2
//   K = pi/(2 a_n),  1 - E/K = sum of 2^(i-1) c_i^2                                                       DLMF 19.8(i)
//   sn, cn, dn of v from those of a_1 v for the modulus c_1/a_1: descending Landen transformations        22.7(i), 22.20(iii)
//   zeta v = integral of dn^2 - E/K from 0 to v = (1 + k') zeta(a_1 v, c_1/a_1) + k^2 sn cn/(1 + dn)      22.16(iii), by 22.7.4
//
// METHOD. At step i sn/cn = a_i s/c, where s = sin(a_n v)/a_n is the same at every step, because 1 + c_i+1/a_i+1 = a_i/a_i+1, and
// c is cos(a_n v) times dn of all the steps after (22.7.2 over 22.7.3); and dn^2 = (c^2 + b_i^2 s^2)/(c^2 + a_i^2 s^2). Every sum
// is of terms of one sign: nothing cancels for k -> 0 or k -> 1, if both moduli are given with all their digits.
// ACCURACY (maximal error: of functions in units of EPSILON (|f| + |u df/du|), which is what rounding f and u costs; of the excess
// in units of EPSILON k^2 u; else in units of EPSILON of the result; down to 1 - m = k'^2 = TINY; measured by tests/test_special.py)
//   function      m           u           float   double
//   K             0 to 1/2    -           2       2
//   K             1/2 to 1    -           3       3
//   E             0 to 1      -           2       2
//   mean_excess   0 to 1      -           2       2
//   excess        0 to 1      to K        3       3
//   sn            0 to 1/2    to K        2       3
//   sn            0 to 1/2    K to 100    2       2
//   sn            1/2 to 1    to K        2       2
//   sn            1/2 to 1    K to 100    3       2
//   cn            0 to 1/2    to K        2       3
//   cn            0 to 1/2    K to 100    2       2
//   cn            1/2 to 1    to K        3       3
//   cn            1/2 to 1    K to 100    3       3
//   dn            0 to 1/2    to K        2       2
//   dn            0 to 1/2    K to 100    2       2
//   dn            1/2 to 1    to K        3       3
//   dn            1/2 to 1    K to 100    3       3
//   zeta          0 to 1/2    to K        3       3
//   zeta          0 to 1/2    K to 100    2       2
//   zeta          1/2 to 1    to K        3       3
//   zeta          1/2 to 1    K to 100    3       3
// A program may say itself how many steps there are at most.
#ifndef AGM_STEPS
#ifdef FP64
#define AGM_STEPS 9
#else
#define AGM_STEPS 7
#endif
#endif
#ifdef FP64
#define HYPERBOLIC_BELOW 1e-16
#define SECH_END 709
#define HALF_PI 1.5707963267948966
#else
#define HYPERBOLIC_BELOW 1e-8f
#define SECH_END 88
#define HALF_PI 1.57079637f
#endif
// AGM_STEPS leave errors of at most 5 units of the table for k' down to 1e-12 (float) and 1e-24 (double). What each k' needs:
//   k'       1   0.9   0.5   0.1   1e-2   1e-3   1e-4   1e-6   1e-8   1e-12   1e-18   1e-24
//   float    0   3     3     4     5      5      6      6      7      7       8
//   double   0   4     5     5     6      7      7      7      8      8       9       9
// For k' below HYPERBOLIC_BELOW K is log(4/k') (19.12), and functions are hyperbolic up to K/2 (22.5(ii)) and mirrored from there on
// (22.4(iii)), with relative errors of k'/2 at most. Beyond SECH_END sech is below TINY.

// Below this b/a their difference loses no digit, whereas a square doubles the relative error of c at every step.
#define DIFFERENCE_BELOW C(0.5)

// All steps up to the last that changes any lane. In a lane that has come to its mean a and b are the same from there on, and c is 0.
typedef struct {
  real a[AGM_STEPS + 1], b[AGM_STEPS + 1], c[AGM_STEPS + 1];
  real quarter;
  int steps;
} agm;

// The mean for the moduli k and k' >= 0; quarter is K, and infinite for k' = 0.
FN agm agm_of(real k, real complement)
{
  agm m;
  m.a[0] = REAL(1);
  m.b[0] = complement;
  m.c[0] = k;
  mask moving = k > REAL(0);
  for (m.steps = 0; m.steps < AGM_STEPS && (m.steps == 0 || ANY(moving)); m.steps++) {
    int i = m.steps;
    real a = m.a[i], b = m.b[i], mean = REAL(C(0.5)) * (a + b), square = m.c[i] * m.c[i];
    // What adds less than EPSILON^2 is left out: it would end in numbers below TINY, which are slow.
    mask apart = b < REAL(DIFFERENCE_BELOW) * a, counts = square > REAL(EPSILON * EPSILON);
    m.a[i + 1] = SELECT(moving, mean, a);
    m.c[i + 1] = SELECT(apart, a - mean, SELECT(counts, square / (REAL(4) * mean), REAL(0)));
    moving = m.c[i + 1] > REAL(0);
    m.b[i + 1] = SELECT(moving, sqrt(a * b), m.a[i + 1]);
  }
  mask limit = complement < REAL(HYPERBOLIC_BELOW);
  m.quarter = REAL(HALF_PI) / m.a[m.steps];
  // log(4/k') without overflow.
  if (ANY(limit)) m.quarter = SELECT(limit, REAL(2) * log(REAL(2) / sqrt(complement)), m.quarter);
  return m;
}

// 1 - E/K, the mean of 1 - dn^2.
FN real mean_excess(const agm *m)
{
  real sum = REAL(0);
  for (int i = m->steps; i >= 0; i--) sum = fma(REAL(2), sum, m->c[i] * m->c[i]);
  return SELECT(m->b[0] < REAL(HYPERBOLIC_BELOW), REAL(1) - REAL(1) / m->quarter, REAL(C(0.5)) * sum);
}

// E = K (E/K) up to m = 1/2; beyond, E/K has lost its digits, and E = pi/(2 K') + K (1 - E'/K') by Legendre's relation (19.7.1).
FN real complete_second(const agm *m)
{
  agm other = agm_of(m->b[0], m->c[0]);
  real K = fmin(m->quarter, REAL(1) / REAL(EPSILON));  // the mean excess is 0 where K is infinite
  real by_legendre = fma(K, mean_excess(&other), other.a[other.steps]);
  return SELECT(m->b[0] < m->c[0], by_legendre, K * (REAL(1) - mean_excess(m)));
}

// sn v for 0 <= v <= K, with cn v >= 0, dn v and zeta v.
FN real jacobi_zeta(const agm *m, real v, real *cosine, real *delta, real *zeta)
{
  real mean = m->a[m->steps], c, s = sin_cos(mean * v, &c) / mean, d = REAL(1), square = REAL(1), sum = REAL(0);
  c = fmax(c, REAL(0));
  for (int i = m->steps - 1; i >= 0; i--) {
    real as = m->a[i] * s, bs = m->b[i] * s;
    c *= d;
    square = fma(as, as, c * c);
    d = sqrt(fma(bs, bs, c * c) / square);
    sum = fma(REAL(2), sum, m->c[i] * m->c[i] * c / (square * (REAL(1) + d)));
  }
  real size = sqrt(square);
  *cosine = c / size;
  *delta = d;
  *zeta = s * sum;
  return s / size;
}

// sn v for 0 <= v <= K, with cn v >= 0, dn v and the excess, which is the integral of 1 - dn^2 from 0 to v.
FN real jacobi(const agm *m, real v, real *cosine, real *delta, real *excess)
{
  real zeta, sine = jacobi_zeta(m, v, cosine, delta, &zeta);
  *excess = fma(v, mean_excess(m), -zeta);
  return sine;
}

// sn u for any u and k' >= 0, with cn u, dn u and zeta u.
FN real jacobi_periodic(const agm *m, real u, real *cosine, real *delta, real *zeta)
{
  // Take off half periods; there are none where K is infinite.
  real K = m->quarter, halves = rint(u / (REAL(2) * K));
  real rest = SELECT(fabs(u) < K, u, fma(-halves, REAL(2) * K, u)), v = fabs(rest);
  real sine = jacobi_zeta(m, v, cosine, delta, zeta);

  // Put in the limit k -> 1.
  mask hyperbolic = m->b[0] < REAL(HYPERBOLIC_BELOW), mirrored = REAL(2) * v > K;
  real x = SELECT(mirrored, K - v, v), cosh_x, sinh_x = sinh_cosh(fmin(x, REAL(SECH_END)), &cosh_x);
  real tanh_x = sinh_x / cosh_x, sech_x = REAL(1) / cosh_x;
  sine = SELECT(hyperbolic, SELECT(mirrored, REAL(1), tanh_x), sine);
  *cosine = SELECT(hyperbolic, SELECT(mirrored, m->b[0] * sinh_x, sech_x), *cosine);
  *delta = SELECT(hyperbolic, SELECT(mirrored, m->b[0] * cosh_x, sech_x), *delta);
  *zeta = SELECT(hyperbolic, SELECT(mirrored, x / K, tanh_x - x / K), *zeta);

  // Put the half periods back.
  real side = copysign(REAL(1), rest), turn = SELECT(IS_ODD(halves), REAL(-1), REAL(1));
  *cosine *= turn;
  *zeta *= side;
  return side * turn * sine;
}
