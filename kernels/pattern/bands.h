// bands.h - lines at whole multiples of the first surface coordinate, which need not be alike: line j has colour |j| mod
// `colors`. Numbers: count of lines a unit; width of a line as a fraction of their spacing; colour of the ground; the `colors`.
FN real3_lanes bands(surface s, scene_data scene, int k, int colors)
{
  real u = s.u * number(scene, k), line = rint(u), half_width = REAL(C(0.5)) * number(scene, k + 1);
  real3_lanes color = color_in_turn(fabs(line), scene, k + 5, colors);
  return select_3(fabs(u - line) < half_width, color, three_numbers(scene, k + 2));
}
