// bulge.h - distance from a circle or sphere that may be flat: which touches the plane y = 0 at the origin, lies below it and has the
// curvature kappa >= 0. Regular at kappa = 0, and without loss where the radius is large (krs.md, "curvature form").
//
// From g = 2 y + kappa (x^2 + y^2) the distance is g/(1 + sqrt(1 + kappa g)); *root is that root, the distance from the centre
// over the radius. ACCURACY in float: 5e-7 of the size for every curvature; sqrt(x^2 + (y + R)^2) - R has no digit at R = 1e7.
FN real above_bulge(real y, real square, real kappa, real *root)
{
  real g = fma(REAL(2), y, kappa * square);
  *root = sqrt(fmax(fma(kappa, g, REAL(1)), REAL(0)));
  return g / (REAL(1) + *root);
}
