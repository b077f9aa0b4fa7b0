// omnidirectional.h - one eye of a panorama in stereo, right all around (omnidirectional stereo, ODS): for every column the eye flows
// from the nose to the side of that column's azimuth, and the direction is transported along (paper 3.4, 3.6).
// Its own number: how far to the right of the nose the eye stands; negative for the left one.
FN ray omnidirectional(real x, real y, scene_data scene, int k)
{
  real ahead, aside = azimuth_of_column(x, scene, k, &ahead), reach = number(scene, k + CAMERA_OWN);
  direction sideways = camera_direction(ahead, REAL(0), -aside, scene, k), arriving = sideways;
  point nose = four_numbers(scene, k), reached = exponential(&arriving, reach, REAL(0));
  point eye = on_model(translate(nose, reached));
  direction u = turn_frame(nose, reached, transport(sideways, reach, REAL(0), equirectangular(x, y, scene, k)));
  return new_ray(eye, push(eye, scale_3(u, unit_correction(dot_3(u, u)))));
}
