// two_part.h - numbers in two parts, high + low, with twice the digits: for the few differences that would lose them.
// Sums and products without rounding (Knuth; Dekker with fma). They rely on FP_CONTRACT being off.

// a + b; *low is what rounding cut off.
FN real two_sum(real a, real b, real *low)
{
  real sum = a + b, b_in = sum - a;
  *low = (a - (sum - b_in)) + (b - b_in);
  return sum;
}

// a b; *low is what rounding cut off.
FN real two_product(real a, real b, real *low)
{
  real product = a * b;
  *low = fma(a, b, -product);
  return product;
}

// pi in two parts.
#ifdef FP64
#define PI_HIGH 3.141592653589793
#define PI_LOW 1.2246467991473532e-16
#else
#define PI_HIGH 3.14159274101257324f
#define PI_LOW -8.742278000372486e-8f
#endif

// sqrt(a^2 + b^2) for sizes whose squares overflow or vanish.
FN real hypotenuse(real a, real b)
{
  real larger = fmax(fabs(a), fabs(b)), smaller = fmin(fabs(a), fabs(b));
  real ratio = smaller / fmax(larger, REAL(TINY));
  return larger * sqrt(fma(ratio, ratio, REAL(1)));
}
