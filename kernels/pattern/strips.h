// strips.h - strips of equal width, in colours that take turns: strip j, from j to j + 1 of `count` a unit of the coordinate x, has
// colour j mod `colors`. Numbers: count; the `colors`.
FN real3_lanes strips(real x, scene_data scene, int k, int colors)
{
  return color_in_turn(floor(x * number(scene, k)), scene, k + 1, colors);
}
