// s2xe.h - S2 x E (paper 8.1-8.4): points (x, y, z, w) with x^2 + y^2 + z^2 = 1 and w on the line, origin o = e_z, metric
// dx^2 + dy^2 + dz^2 + dw^2. What S2 needs beyond s3.h and isotropic.h; the contract is in product.h.
//
// METHOD. Geodesics between two points wind about S2 both ways, any number of times: product.h. Frames have one singular
// point, that of S2 opposite o; a frame over it is that of a point next to it, for which the formulas of s3.h do not cancel.
// ACCURACY (maximal error relative to the largest entry, tests/test_golden_products.py, tests/stability; directions are rounded first)
//   quantity                                              float     double
//   flow: point, velocity, transport; t < 6.3             8.2e-7    1.1e-15   then, on S2, t EPSILON/2
//   distance and lengths, also near or antipodal points   2.5e-7    3.2e-16
//   directions of the first 8 geodesics                   3.2e-7    5.9e-16
//   area density; the worst stands next to a zero         2.6e-5    5.7e-14

// Nearest to the antipode of o that a frame is taken: below all rounding, and its square is still a normal number.
#ifdef FP64
#define ANTIPODE_OFFSET 0x1p-510
#else
#define ANTIPODE_OFFSET 0x1p-61f
#endif

// The point of S2 (x, y, 0, z) whose frame stands for the one at y: y itself, or nearer to the antipode of o than that a point
// in the same direction, for which the antipode itself has +x.
FN point frame_point(point y)
{
  real offset = fmax(fabs(y.x), fabs(y.y));
  mask near = (y.w < REAL(0)) & (offset < REAL(ANTIPODE_OFFSET)), there = NOT(offset > REAL(0));
  real scale = REAL(ANTIPODE_OFFSET) / SELECT(there, REAL(1), offset);
  y.x = SELECT(near, SELECT(there, REAL(ANTIPODE_OFFSET), y.x * scale), y.x);
  y.y = SELECT(near, y.y * scale, y.y);
  return y;
}

// Arrived at the antipode, a sine of 0 would forget the direction of arrival, by which the frame there is chosen.
FN real arriving_sine(real sine, real cosine)
{
  return SELECT(cosine < REAL(0), copysign(fmax(fabs(sine), REAL(ANTIPODE_OFFSET)), sine), sine);
}

// The length of the part of a unit vector v that is tangent to S2.
FN real factor_speed(vector v) { return sqrt(dot_3(first_3(v), first_3(v))); }
