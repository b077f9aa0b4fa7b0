// elementary.h - stable elementary functions on lanes, branch-free, without tables or calls.
//
// exp, log, sqrt and division are the device's own. Everything else is written here, because the vector forms of sincos,
// atan2, asinh, sinh and cosh cost two to six times as much on PoCL, and because the naive forms lose digits near 0.
//
// ACCURACY (maximal error in units of EPSILON of the result, 2e5 points each; measured by tests/test_elementary.py)
//   function        domain                 float   double  note
//   sin_cos         |x| <= 1e3             1       1       absolute error: relative near the zeros of the result is lost
//   arc_tangent_2   all quadrants          2       1
//   log_1p          x > -1/2               2       2       NaN, not inf, at inf
//   area_sinh       x >= 0, finite         2       2       NaN, not inf, at inf
//   area_sinh_odd   finite                 2       2       NaN, not inf, at inf
//   area_cosh       x >= 2, to overflow    2       2       used only away from 1: elsewhere change the variable
//   sinh_cosh       |t| <= 20              2       2
#ifdef FP64
// fdlibm's minimax kernels on [-pi/4, pi/4]; pi/2 in three parts (Cody and Waite), exact for |x| below 1e5.
#define HALF_PI_HIGH -1.5707963267341256
#define HALF_PI_MIDDLE -6.077100506303966e-11
#define HALF_PI_LOW -2.0222662487959506e-21
FN real sine_kernel(real r, real z)
{
  real s = REAL(1.58969099521155010221e-10);
  s = fma(s, z, REAL(-2.50507602534068634195e-08));
  s = fma(s, z, REAL(2.75573137070700676789e-06));
  s = fma(s, z, REAL(-1.98412698298579493134e-04));
  s = fma(s, z, REAL(8.33333333332248946124e-03));
  s = fma(s, z, REAL(-1.66666666666666324348e-01));
  return fma(s * z, r, r);
}
FN real cosine_kernel(real z)
{
  real c = REAL(-1.13596475577881948265e-11);
  c = fma(c, z, REAL(2.08757232129817482790e-09));
  c = fma(c, z, REAL(-2.75573143513906633035e-07));
  c = fma(c, z, REAL(2.48015872894767294178e-05));
  c = fma(c, z, REAL(-1.38888888888741095749e-03));
  c = fma(c, z, REAL(4.16666666666666019037e-02));
  return fma(c, z * z, fma(REAL(-0.5), z, REAL(1)));
}
#else
// Cephes' single-precision kernels on [-pi/4, pi/4]; pi/2 in three parts.
#define HALF_PI_HIGH -1.5703125f
#define HALF_PI_MIDDLE -4.837512969970703125e-4f
#define HALF_PI_LOW -7.549789948768648e-8f
FN real sine_kernel(real r, real z)
{
  real s = fma(fma(REAL(-1.9515295891e-4f), z, REAL(8.3321608736e-3f)), z, REAL(-1.6666654611e-1f));
  return fma(s * z, r, r);
}
FN real cosine_kernel(real z)
{
  real c = fma(fma(REAL(2.443315711809948e-5f), z, REAL(-1.388731625493765e-3f)), z, REAL(4.166664568298827e-2f));
  return fma(c, z * z, fma(REAL(-0.5f), z, REAL(1)));
}
#endif

// sin x; *cosine = cos x.
FN real sin_cos(real x, real *cosine)
{
  real k = rint(x * REAL(C(0.63661977236758134)));
  real r = fma(k, REAL(HALF_PI_LOW), fma(k, REAL(HALF_PI_MIDDLE), fma(k, REAL(HALF_PI_HIGH), x)));
  real z = r * r, s = sine_kernel(r, z), c = cosine_kernel(z);
  real half_k = floor(REAL(C(0.5)) * k), half_k_1 = floor(REAL(C(0.5)) * (k + REAL(1)));
  mask swapped = IS_ODD(k), s_negative = IS_ODD(half_k), c_negative = IS_ODD(half_k_1);
  real sine = SELECT(swapped, c, s), cos_x = SELECT(swapped, s, c);
  *cosine = SELECT(c_negative, -cos_x, cos_x);
  return SELECT(s_negative, -sine, sine);
}

// The angle of the point (x, y), in [-pi, pi]; 0 at the origin.
FN real arc_tangent_2(real y, real x)
{
#ifdef FP64
  return atan2(y, x);
#else
  // Odd polynomial of degree 17 on [0, 1], minimax in relative error.
  real ax = fabs(x), ay = fabs(y), larger = fmax(ax, ay), smaller = fmin(ax, ay);
  real a = smaller / fmax(larger, REAL(TINY)), s = a * a, r = REAL(0x1.7ed1ccp-9f);
  r = fma(r, s, REAL(-0x1.0c2c08p-6f));
  r = fma(r, s, REAL(0x1.61fdd0p-5f));
  r = fma(r, s, REAL(-0x1.3556b2p-4f));
  r = fma(r, s, REAL(0x1.b4e128p-4f));
  r = fma(r, s, REAL(-0x1.230ad2p-3f));
  r = fma(r, s, REAL(0x1.9978ecp-3f));
  r = fma(r, s, REAL(-0x1.5554dcp-2f));
  r = fma(r * s, a, a);
  r = SELECT(ay > ax, REAL(1.57079637f) - r, r);
  r = SELECT(x < REAL(0), REAL(3.14159274f) - r, r);
  return copysign(r, y);
#endif
}

// log(1 + x): what rounding 1 + x to u left out is added back to first order.
FN real log_1p(real x)
{
  real u = REAL(1) + x;
  return log(u) + (x - (u - REAL(1))) / u;
}

// 1/sqrt(n) for n near 1: one Newton step from 1, whose error is 3/8 (n - 1)^2. For undoing rounding.
FN real unit_correction(real n) { return fma(REAL(C(-0.5)), n, REAL(C(1.5))); }

// Sizes whose squares would vanish or overflow, and the power of two that brings them to where they do not.
#ifdef FP64
#define SQUARES_VANISH_BELOW 0x1p-400
#define SQUARES_OVERFLOW_ABOVE 0x1p400
#define SQUARE_SCALE 0x1p600
#define SQUARE_SCALE_BACK 0x1p-600
#else
#define SQUARES_VANISH_BELOW 0x1p-40f
#define SQUARES_OVERFLOW_ABOVE 0x1p40f
#define SQUARE_SCALE 0x1p80f
#define SQUARE_SCALE_BACK 0x1p-80f
#endif
// What to scale by before the sum of squares of numbers up to this size is formed, without rounding; *back is its inverse.
FN real square_scale(real size, real *back)
{
  mask small = size < REAL(SQUARES_VANISH_BELOW), large = size > REAL(SQUARES_OVERFLOW_ABOVE);
  *back = SELECT(small, REAL(SQUARE_SCALE_BACK), SELECT(large, REAL(SQUARE_SCALE), REAL(1)));
  return SELECT(small, REAL(SQUARE_SCALE), SELECT(large, REAL(SQUARE_SCALE_BACK), REAL(1)));
}

// asinh x for x >= 0, from x + x^2/(1 + sqrt(1 + x^2)) written so that no square overflows.
FN real area_sinh(real x)
{
  real t = REAL(1) / x;
  return log_1p(x + x / (t + sqrt(fma(t, t, REAL(1)))));
}

// asinh x for x of both signs.
FN real area_sinh_odd(real x) { return copysign(area_sinh(fabs(x)), x); }

// acosh x for x >= 2; nearer to 1 the caller has a stable variable and uses area_sinh.
FN real area_cosh(real x)
{
  real t = REAL(1) / x;
  return log(x) + log_1p(sqrt((REAL(1) - t) * (REAL(1) + t)));
}

// Below this |t| the difference e^t - e^-t loses more digits than the odd series of the same length keeps.
#define SINH_SERIES_BELOW 1
// sinh t; *cosine = cosh t.
FN real sinh_cosh(real t, real *cosine)
{
  real e = exp(t), inverse = REAL(1) / e, z = t * t;
#ifdef FP64
  real s = REAL(2.8114572543455206e-15);
  s = fma(s, z, REAL(7.647163731819816e-13));
  s = fma(s, z, REAL(1.6059043836821613e-10));
  s = fma(s, z, REAL(2.505210838544172e-08));
  s = fma(s, z, REAL(2.755731922398589e-06));
  s = fma(s, z, REAL(1.984126984126984e-04));
  s = fma(s, z, REAL(8.333333333333333e-03));
  s = fma(s, z, REAL(1.6666666666666666e-01));
#else
  real s = fma(REAL(2.7557319e-06f), z, REAL(1.98412698e-04f));
  s = fma(s, z, REAL(8.33333333e-03f));
  s = fma(s, z, REAL(1.66666667e-01f));
#endif
  *cosine = REAL(C(0.5)) * (e + inverse);
  return SELECT(fabs(t) < REAL(SINH_SERIES_BELOW), fma(s * z, t, t), REAL(C(0.5)) * (e - inverse));
}
