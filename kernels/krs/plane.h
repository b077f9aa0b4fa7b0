// plane.h - a half-space as a kernel of a sequence, bounded by a totally geodesic plane. Numbers: a form (4) and its constant term,
// positive outside; 1 where the form is the sine of the distance, 0 where it is the distance itself (in e3, and of a horizontal plane
// of a product); two forms (8) whose values are the coordinates on it.
#define KRS_PLANE 2
FN real krs_plane_distance(point x, scene_data scene, int k)
{
#if CURVATURE == 0
  return dot_3(first_3(x), three_numbers(scene, k)) + number(scene, k + 4);
#else
  real side = dot_4(x, four_numbers(scene, k)) + number(scene, k + 4);
  return scene.numbers[k + 5] > 0 ? arc_of_sine(side) : side;
#endif
}

FN surface krs_plane_surface(point x, scene_data scene, int k)
{
  surface s = {krs_plane_distance(x, scene, k), four_numbers(scene, k), dot_4(x, four_numbers(scene, k + 6)),
               dot_4(x, four_numbers(scene, k + 10))};
  return s;
}
