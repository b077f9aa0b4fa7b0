// bulge.h - distance from a circle or sphere that may be flat: which touches the plane y = 0 at the origin, lies below it and has the
// curvature kappa >= 0. Regular at kappa = 0, and without loss where the radius is large (docs/krs.md, "Kernels").
//
// From g = 2 y + kappa (x^2 + y^2) the distance is g/(1 + *root), *root the distance from the centre over the radius: sqrt(1 + kappa g),
// of which half the digits cancel next to the centre, but not of the length of (1 + kappa y, kappa x). ACCURACY in float: 5e-7 of the
// size for every curvature; sqrt(x^2 + (y + R)^2) - R has no digit at R = 1e7.
FN real above_bulge(real y, real x_square, real kappa, real *root)
{
  real g = fma(REAL(2), y, kappa * fma(y, y, x_square)), up = fma(kappa, y, REAL(1));
  *root = sqrt(fma(up, up, kappa * kappa * x_square));
  return g / (REAL(1) + *root);
}
