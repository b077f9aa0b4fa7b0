// h2xe.h - H2 x E (paper 8.1-8.4): points (x, y, z, w) with x^2 + y^2 - z^2 = -1, z > 0 and w on the line, origin o = e_z,
// metric dx^2 + dy^2 - dz^2 + dw^2. What H2 needs beyond h3.h and isotropic.h; the contract is in product.h.
//
// METHOD. One geodesic between two points. As in h3, coordinates quantise a position at EPSILON e^distance.
// RANGE. Squares of coordinates overflow where H2 is crossed by 44 in float, 354 in double.
// ACCURACY (maximal error relative to the largest entry, tests/test_golden_products.py; directions are rounded first)
//   quantity                                              float     double
//   flow: point and velocity; t < 6.3, t from 10 to 40    2.3e-6    4.2e-15   then t EPSILON/2
//   transport                                             7.1e-7    8.3e-16
//   distance and length, also of near points              1.7e-7    4.0e-16
//   the same 6 from the origin (test_products.py)         5.2e-6    9.8e-15
//   the same 12 from the origin                           1.9e-3    2.9e-12
//   direction                                             3.5e-7    1.1e-15
//   area density                                          4.4e-7    4.5e-16

// Every point of H2 has a frame, and no sine is 0 but at the start.
FN point frame_point(point y) { return y; }
FN real arriving_sine(real sine, real cosine) { return sine; }

// The length of the part of a unit vector v that is tangent to H2: x^2 + y^2 - z^2 would cancel far out.
FN real factor_speed(vector v) { return sqrt(fmax((REAL(1) - v.w) * (REAL(1) + v.w), REAL(0))); }
