// carlson.h - Carlson's symmetric elliptic integrals R_F(x, y, 1) and R_D(x, y, 1) in one loop (DLMF 19.16.1, 19.16.5).
//
// METHOD. Duplication (DLMF 19.26.18, 19.26.20), which brings the arguments together, then the series about their mean
// (DLMF 19.36.1, 19.36.2). Where x and y are both small, the first rounds do little but for a square root of them.
// ACCURACY (maximal relative error for 0 <= x <= y <= 1; tests/test_carlson.py)
//   y from       1e-10    1e-20    1e-30
//   R_F float    3.2e-7   3.6e-7   1.1e-6
//   R_D float    3.6e-7   4.2e-7   6.5e-7
//   R_F double   9.0e-16  1.4e-15  6.5e-14
//   R_D double   9.0e-16  9.0e-16  2.8e-15

#ifdef FP64
#define DUPLICATIONS 8
#else
#define DUPLICATIONS 6
#endif
FN real carlson_f_and_d(real x, real y, real *d)
{
  real z = REAL(1), sum = REAL(0);
  scalar part = 1;
  for (int i = 0; i < DUPLICATIONS; i++) {
    real root_x = sqrt(x), root_y = sqrt(y), root_z = sqrt(z);
    real shift = fma(root_x, root_y + root_z, root_y * root_z);
    sum = fma(REAL(part), REAL(1) / (root_z * (z + shift)), sum);
    part *= C(0.25);
    x = REAL(C(0.25)) * (x + shift);
    y = REAL(C(0.25)) * (y + shift);
    z = REAL(C(0.25)) * (z + shift);
  }
  // About the mean with z once, of R_F; about that with z three times, of R_D.
  real mean = (x + y + z) * REAL(C(0.33333333333333333)), inverse = REAL(1) / mean;
  real a = (mean - x) * inverse, b = (mean - y) * inverse, c = -a - b;
  real e_2 = fma(a, b, -c * c), e_3 = a * b * c;
  real f = fma(e_2, fma(e_2, REAL(C(0.041666666666666667)), fma(e_3, REAL(C(-0.068181818181818182)), REAL(C(-0.1)))),
               fma(e_3, REAL(C(0.071428571428571429)), REAL(1)));
  f *= sqrt(inverse);

  mean = (x + y + REAL(3) * z) * REAL(C(0.2));
  inverse = REAL(1) / mean;
  a = (mean - x) * inverse;
  b = (mean - y) * inverse;
  c = (a + b) * REAL(C(-0.33333333333333333));
  real ab = a * b, cc = c * c;
  e_2 = fma(REAL(-6), cc, ab);
  e_3 = fma(REAL(3), ab, REAL(-8) * cc) * c;
  real e_4 = REAL(3) * (ab - cc) * cc, e_5 = ab * c * cc;
  real series = fma(e_2, fma(e_2, REAL(C(0.10227272727272727)), fma(e_3, REAL(C(-0.17307692307692308)), REAL(C(-0.21428571428571429)))),
                    fma(e_3, REAL(C(0.16666666666666667)), fma(e_4, REAL(C(-0.13636363636363636)),
                                                                fma(e_5, REAL(C(0.11538461538461538)), REAL(1)))));
  *d = fma(REAL(3), sum, REAL(part) * series * inverse * sqrt(inverse));
  return f;
}
