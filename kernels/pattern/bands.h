// bands.h - lines at whole multiples of the first surface coordinate, which need not be alike: line j has colour |j| mod
// `colors`. Numbers: count of lines a unit; width of a line as a fraction of their spacing; colour of the ground; the `colors`.
FN real3_lanes bands(surface s, scene_data scene, int k, int colors)
{
  real u = s.u * number(scene, k), line = rint(u), j = fabs(line), half_width = REAL(C(0.5)) * number(scene, k + 1);
  // A half keeps the quotient away from whole numbers, which a device may miss by its last digit.
  real turn = fma(floor((j + REAL(C(0.5))) / REAL(colors)), REAL(-colors), j);
  real3_lanes color = three_numbers(scene, k + 5);
  for (int i = 1; i < colors; i++) color = select_3(turn == REAL(i), three_numbers(scene, k + 5 + 3 * i), color);
  return select_3(fabs(u - line) < half_width, color, three_numbers(scene, k + 2));
}
