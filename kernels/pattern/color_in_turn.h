// color_in_turn.h - of `colors` colours, which stand in the numbers from k on, that of the whole number j: they take turns.
FN real3_lanes color_in_turn(real j, scene_data scene, int k, int colors)
{
  // A half keeps the quotient away from whole numbers, which a device may miss by its last digit.
  real turn = fma(floor((j + REAL(C(0.5))) / REAL(colors)), REAL(-colors), j);
  real3_lanes color = three_numbers(scene, k);
  for (int i = 1; i < colors; i++) color = select_3(turn == REAL(i), three_numbers(scene, k + 3 * i), color);
  return color;
}
