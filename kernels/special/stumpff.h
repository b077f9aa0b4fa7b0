// stumpff.h - the entire functions of s that make the geodesic flows of nil and sl2 free of cases (Stumpff functions).
//
//   C0(s) = cos x       | cosh y        with x = sqrt(s) where s >= 0, y = sqrt(-s) where s <= 0
//   S0(s) = sin x / x   | sinh y / y    S0(0) = 1
//   S1(s) = dS0/ds = (C0 - S0)/(2 s)    S1(0) = -1/6
//   D(s)  = (1 - C0 S0)/(2 s)           D(0) = 1/3
//
// METHOD. S1 and D cancel for small |s| and only there: Taylor series below STUMPFF_SERIES_BELOW, closed forms from there on.
// ACCURACY (maximal error in units of EPSILON times x A, A, A/x and D, where A = max(|C0|, x |S0|) is the amplitude and
// x = max(1, sqrt |s|): the rounding of the root is a phase; measured by tests/test_stumpff.py)
//   function   domain               float   double   note
//   C0         -400 <= s <= 400     1       1        beyond -400 and for t > 20 poor as sinh_cosh is: EPSILON y
//   S0         -400 <= s <= 400     1       1
//   S1         -400 <= s <= 400     1       1
//   D          0 <= s <= 400        2       1        never used of negative s

// The sine of T over T from that sine: S0(T^2).
FN real sine_over(real sine, real T)
{
  mask small = fabs(T) < REAL(TINY);
  return SELECT(small, REAL(1), sine / SELECT(small, REAL(1), T));
}

// S0(s); *c0 = C0(s).
FN real stumpff(real s, real *c0)
{
  real root = sqrt(fabs(s)), cosine, hyperbolic_cosine;
  real sine = sin_cos(root, &cosine), hyperbolic_sine = sinh_cosh(root, &hyperbolic_cosine);
  mask hyperbolic = s < REAL(0);
  *c0 = SELECT(hyperbolic, hyperbolic_cosine, cosine);
  return sine_over(SELECT(hyperbolic, hyperbolic_sine, sine), root);
}

// Below this |s| the series have the precision of the type in 6 and 8 terms (single), 10 and 14 (double).
#define STUMPFF_SERIES_BELOW 1

FN real stumpff_s1(real s, real c0, real s0)
{
#ifdef FP64
  real r = REAL(1.9572941063391261e-19);
  r = fma(r, s, REAL(-7.398571721961897e-17));
  r = fma(r, s, REAL(2.2491658034764165e-14));
  r = fma(r, s, REAL(-5.353014612273871e-12));
  r = fma(r, s, REAL(9.635426302092969e-10));
#else
  real r = REAL(9.635426302092969e-10f);
#endif
  r = fma(r, s, REAL(C(-1.252605419272086e-07)));
  r = fma(r, s, REAL(C(1.1022927689594357e-05)));
  r = fma(r, s, REAL(C(-5.952380952380953e-04)));
  r = fma(r, s, REAL(C(1.6666666666666666e-02)));
  r = fma(r, s, REAL(C(-1.6666666666666666e-01)));
  mask small = fabs(s) < REAL(STUMPFF_SERIES_BELOW);
  return SELECT(small, r, (c0 - s0) / SELECT(small, REAL(1), REAL(2) * s));
}

FN real stumpff_d(real s, real c0, real s0)
{
#ifdef FP64
  real r = REAL(-1.5179975223833344e-23);
  r = fma(r, s, REAL(3.081534970438169e-21));
  r = fma(r, s, REAL(-5.408093873118987e-19));
  r = fma(r, s, REAL(8.11214080967848e-17));
  r = fma(r, s, REAL(-1.0261858124243278e-14));
  r = fma(r, s, REAL(1.0774951030455441e-12));
  r = fma(r, s, REAL(-9.212583131039402e-11));
#else
  real r = REAL(-9.212583131039402e-11f);
#endif
  r = fma(r, s, REAL(C(6.264556529106794e-09)));
  r = fma(r, s, REAL(C(-3.2888921777810664e-07)));
  r = fma(r, s, REAL(C(1.282667949334616e-05)));
  r = fma(r, s, REAL(C(-3.527336860670194e-04)));
  r = fma(r, s, REAL(C(6.349206349206349e-03)));
  r = fma(r, s, REAL(C(-6.666666666666667e-02)));
  r = fma(r, s, REAL(C(3.333333333333333e-01)));
  mask small = fabs(s) < REAL(STUMPFF_SERIES_BELOW);
  return SELECT(small, r, fma(-c0, s0, REAL(1)) / SELECT(small, REAL(1), REAL(2) * s));
}
