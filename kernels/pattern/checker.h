// checker.h - a chessboard: `count` squares a unit of each surface coordinate, two colours. Numbers: count u, v; two colours.
FN real3_lanes checker(surface s, scene_data scene, int k)
{
  real sum = floor(s.u * number(scene, k)) + floor(s.v * number(scene, k + 1));
  return select_3(IS_ODD(sum), three_numbers(scene, k + 5), three_numbers(scene, k + 2));
}
