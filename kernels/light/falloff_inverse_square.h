// falloff_inverse_square.h - light fades as 1/length^2 of its geodesic, as in Euclidean space, whatever the geometry (paper 5.9).

// Nearer than this a light is as bright as it gets: a million times its intensity, as by falloff_area.h.
#define SQUARE_LENGTH_FLOOR C(1e-3)

FN real falloff_inverse_square(arrival a)
{
  // Unlike fmax this keeps a NaN.
  real length = SELECT(a.length < REAL(SQUARE_LENGTH_FLOOR), REAL(SQUARE_LENGTH_FLOOR), a.length);
  return a.intensity / (length * length);
}
