// strips.h - strips of equal width, in colours that take turns: strip j, from j to j + 1 of `count` a unit of the coordinate x, has
// colour j mod `colors`. Numbers: count; the `colors`.
FN real3_lanes strips(real x, scene_data scene, int k, int colors)
{
  real j = floor(x * number(scene, k));
  // A half keeps the quotient away from whole numbers, which a device may miss by its last digit.
  real turn = fma(floor((j + REAL(C(0.5))) / REAL(colors)), REAL(-colors), j);
  real3_lanes color = three_numbers(scene, k + 1);
  for (int i = 1; i < colors; i++) color = select_3(turn == REAL(i), three_numbers(scene, k + 1 + 3 * i), color);
  return color;
}
