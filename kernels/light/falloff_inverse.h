// falloff_inverse.h - light fades as 1/length of its geodesic: a cue of depth, not physics (paper 5.9).

// Nearer than this a light is as bright as it gets.
#define LENGTH_FLOOR C(1e-3)

FN real falloff_inverse(arrival a)
{
  // Unlike fmax this keeps a NaN.
  return a.intensity / SELECT(a.length < REAL(LENGTH_FLOOR), REAL(LENGTH_FLOOR), a.length);
}
