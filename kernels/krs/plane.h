// plane.h - a half-space as a kernel of a sequence, bounded by a totally geodesic plane. Numbers: a form (4) and its constant term,
// positive outside; 1 where the form is the sine of the distance, 0 where it is the distance itself (in e3, and of a horizontal plane
// of a product); two forms (8) that are zero on it at lines of it, and outside e3 one more (4), 1 where these lines meet.
// Coordinates: those of half-spaces (half_space.h, vertical_half_space.h, horizontal_half_space.h).
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
  real first = dot_4(x, four_numbers(scene, k + 6)), second = dot_4(x, four_numbers(scene, k + 10));
#if CURVATURE != 0
  real w = dot_4(x, four_numbers(scene, k + 14));
#if HOMOGENEOUS == 5
  if (scene.numbers[k + 5] > 0) {
    first = axis_length(first, REAL(0), w);
  } else {
    real along = axis_length(first, second * second, w);
    first = arc_of_sine(second);
    second = along;
  }
#else
  first = axis_length(first, second * second, w);
  second = arc_of_sine(second);
#endif
#endif
  surface s = {krs_plane_distance(x, scene, k), four_numbers(scene, k), first, second};
  return s;
}
