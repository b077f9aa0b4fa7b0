// grid.h - lines on a ground: `count` squares a unit of each surface coordinate. Numbers: count u, v; width of a line as a
// fraction of a square; colour of the lines; colour of the ground.
FN real3_lanes grid(surface s, scene_data scene, int k)
{
  real u = s.u * number(scene, k), v = s.v * number(scene, k + 1), half_width = REAL(C(0.5)) * number(scene, k + 2);
  mask line = (fabs(u - rint(u)) < half_width) | (fabs(v - rint(v)) < half_width);
  return select_3(line, three_numbers(scene, k + 3), three_numbers(scene, k + 6));
}
