// sol_phase.h - the elliptic functions of a geodesic of Sol, at one phase.
//
// With (a, b, c) the direction somewhere, a, b >= 0 by symmetry, and m = ab: mu^2 = 1 + 2m, k' = 2 sqrt(m)/mu, and
// k = sqrt((a - b)^2 + c^2)/mu, which does not cancel as 2m -> 1 (paper 11.2). By the time t the phase mu t passes. The only integral
// of the second kind that is wanted is
//     I(v) = int_0^v sn^2 cn dn/(dn + cn)^2.
// In single precision, phases up to SHORT_PHASE, most of a ray's steps, take series at a fourth of them and two duplications,
//     I(2v) = 2 I(v) + 2 S r^2 - S_2 r_2^2 + (4 S^3/(1 - k^2 S^4)) (((1 + k^2)/2 + k^2 S^2) r^2 + 1/2),   r = S/(dn + cn),
// and a quarter of the time of the arithmetic-geometric mean.
// ACCURACY (maximal error; tests/test_sol_flow.py): of I, relative to v, 8.2e-7 in float, 1.7e-15 in double, most just below
// CLOSED_BELOW; short phases: sn, cn, dn and sn/(dn + cn) 2.5e-7 of themselves, I 2e-6.

// What is the same all along a geodesic.
typedef struct { real m, mu, k, complement; } invariants;

FN invariants invariants_of(real a, real b, real c)
{
  invariants i;
  i.m = a * b;
  i.mu = sqrt(fma(REAL(2), i.m, REAL(1)));
  i.k = fmin(sqrt(fma(a - b, a - b, c * c)) / i.mu, REAL(1));
  i.complement = fmin(REAL(2) * sqrt(a) * sqrt(b) / i.mu, REAL(1));
  return i;
}

// Below this k the closed form with the excess, the integral of 1 - dn^2, keeps the digits of I; above, steps towards k = 1, whose remainder
// falls like k'^2, then k'^4, ...
#define CLOSED_BELOW C(0.6)
#ifdef FP64
#define ASCENTS 3
#else
#define ASCENTS 2
#endif
// I(v) for 0 <= v <= K from s, c, d = sn, cn, dn v and the excess, which only counts below CLOSED_BELOW.
FN real height_integral(real v, real s, real c, real d, real k, real complement, real excess)
{
  mask closed = k < REAL(CLOSED_BELOW);
  real result = REAL(0);
  if (ANY(closed)) {
    real square = complement * complement, rs = s / (d + c);
    result = fma(fma(REAL(-2), square, REAL(4)), v - s, REAL(-4) * excess) / (square * square) - s * rs * rs;
  }
  if (ANY(NOT(closed))) {
    real modulus = fmax(k, REAL(CLOSED_BELOW)), rest = SELECT(closed, REAL(1) - modulus, complement * complement / (REAL(1) + k));
    real sum = REAL(0), weight = REAL(1);
    for (int i = 0; i < ASCENTS; i++) {
      real one_k = REAL(1) + modulus, inverse = REAL(1) / one_k, next = rest * inverse;
      real square = s * s, q = modulus * square, less = fma(modulus, c * c, rest), product = c * d;
      // cn and dn are 0 together only where k' is, and then what they divide is 0 too.
      real both = fmax(c + d, REAL(TINY)), root = fmax(less + product, REAL(TINY)), down = REAL(1) / (REAL(1) + q);
      real bend = next / root, wide = less / both / both;
      sum = fma(weight, (v - s * down) * inverse * inverse - square * s * down * fma(REAL(C(-0.5)) * bend, bend, wide), sum);
      weight *= REAL(C(0.5)) * next * next * inverse * inverse * inverse;
      s *= one_k * down;
      c = product * down;
      d = less * down;
      v *= one_k;
      modulus = REAL(2) * sqrt(modulus) * inverse;
      rest = next * next / (REAL(1) + modulus);
    }
    result = SELECT(closed, result, sum);
  }
  return fmax(result, REAL(0));
}

// Half of what a whole half period 2K of v covers of x a and y b, less 1: from I(K).
FN real half_period_gain(invariants i, const agm *mean)
{
  real inverse = REAL(1) / i.mu, excess = mean->quarter * mean_excess(mean);
  real integral = height_integral(mean->quarter, REAL(1), REAL(0), i.complement, i.k, i.complement, excess);
  return i.m * i.m * (inverse / (REAL(1) + i.m + i.mu) + REAL(4) * integral * inverse * inverse * inverse);
}

// sn, cn, dn at the phase of a step, sn/(dn + cn) and I.
typedef struct { real s, c, d, ratio, integral; } phase;

FN phase select_phase(mask m, phase a, phase b)
{
  phase p = {SELECT(m, a.s, b.s), SELECT(m, a.c, b.c), SELECT(m, a.d, b.d), SELECT(m, a.ratio, b.ratio),
             SELECT(m, a.integral, b.integral)};
  return p;
}

#ifndef FP64
#define SHORT_PHASE 1
// For 0 <= v <= SHORT_PHASE.
FN phase short_phase(real v, real k)
{
  real q = k * k, x = REAL(0.25f) * v, z = x * x, sum = q + REAL(1), unit = REAL(1);
  real ninth = fma(q, fma(q, fma(q, q + REAL(1228), REAL(5478)), REAL(1228)), unit) * REAL(1.0f / 362880);
  real seventh = sum * fma(q, q + REAL(134), unit) * REAL(-1.0f / 5040), fifth = fma(q, q + REAL(14), unit) * REAL(1.0f / 120);
  real series = fma(z, fma(z, fma(z, ninth, seventh), fifth), sum * REAL(-1.0f / 6));
  phase p;
  p.s = fma(x * z, series, x);
  real square = p.s * p.s;
  p.c = sqrt(unit - square);
  p.d = sqrt(fma(-q, square, unit));
  p.ratio = p.s / (p.d + p.c);
  real bend = fma(z, fma(q, fma(q, REAL(-13), REAL(298)), REAL(-13)) * REAL(1.0f / 20160), sum * REAL(-1.0f / 60));
  p.integral = x * z * fma(z, bend, REAL(1.0f / 12));
  for (int i = 0; i < 2; i++) {
    real s = p.s, inverse = unit / fma(-q * square, square, unit), ratio = p.ratio * p.ratio, twice = REAL(-2) * square * inverse;
    p.s = REAL(2) * s * p.c * p.d * inverse;
    real c = fma(twice, p.d * p.d, unit);
    p.d = fma(q * twice, p.c * p.c, unit);
    p.c = c;
    p.ratio = p.s / (p.d + p.c);
    real gain = fma(fma(q, square, REAL(0.5f) * sum), ratio, REAL(0.5f)) * square * inverse;
    p.integral = fma(REAL(2), fma(s, fma(REAL(2), gain, ratio), p.integral), -p.s * p.ratio * p.ratio);
    square = p.s * p.s;
  }
  return p;
}
#else
// Double precision takes no short cut.
#define SHORT_PHASE 0
FN phase short_phase(real v, real k)
{
  phase p = {v, REAL(1), REAL(1), REAL(0.5) * v, REAL(0)};
  return p;
}
#endif

// Where k' e^v is below this, its square, which is what is neglected, is below rounding.
#ifdef FP64
#define PLANAR_BELOW 1e-8
#else
#define PLANAR_BELOW 3e-4f
#endif
// e^v is not worked out beyond this v, where it nears the end of the numbers.
#ifdef FP64
#define PHASE_END 700
#else
#define PHASE_END 80
#endif

// At half of the time that is left when `halves` half periods 2K are taken off; of what each of these covers, `gain` is the half less 1.
// Where k' e^v is negligible, sn v = tanh v and cn v = dn v = 1/cosh v: planes, the vertical, and what is next to them.
FN phase long_phase(invariants i, real time, real *halves, real *gain)
{
  real zero = REAL(0), one = REAL(1), v = REAL(C(0.5)) * i.mu * time, excess = zero;
  mask planar = i.complement * exp(fmin(v, REAL(PHASE_END))) < REAL(PLANAR_BELOW);
  agm mean = agm_of(SELECT(planar, zero, i.k), SELECT(planar, one, i.complement));
  *halves = SELECT(planar, zero, floor(v / mean.quarter));
  v = SELECT(planar, v, fmin(fmax(fma(-*halves, mean.quarter, v), zero), mean.quarter));
  phase p;
  p.s = jacobi(&mean, SELECT(planar, zero, v), &p.c, &p.d, &excess);
  if (ANY(planar)) {
    real cosine, sine = sinh_cosh(SELECT(planar, fmin(v, REAL(PHASE_END)), zero), &cosine), inverse = one / cosine;
    p.s = SELECT(planar, sine * inverse, p.s);
    p.c = SELECT(planar, inverse, p.c);
    p.d = SELECT(planar, inverse, p.d);
  }
  p.ratio = p.s / (p.d + p.c);
  p.integral = height_integral(v, p.s, p.c, p.d, SELECT(planar, one, i.k), SELECT(planar, zero, i.complement), excess);
  *gain = zero;
  if (ANY(*halves > zero)) *gain = half_period_gain(i, &mean);
  return p;
}
