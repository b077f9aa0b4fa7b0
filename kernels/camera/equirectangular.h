// equirectangular.h - all directions: columns are azimuths, 360 degrees from edge to edge, and rows are heights, from the camera's up
// at the top edge to its down at the bottom edge. Forward is in the middle. Places beyond an edge go on round, and over the poles.

// Sine and cosine of the azimuth of a column, from forward to the right.
FN real azimuth_of_column(real x, scene_data scene, int k, real *cosine)
{
  return sin_cos(right_of_middle(x, REAL(C(6.28318530717958648)) / number(scene, k + CAMERA_WIDTH), scene, k), cosine);
}

FN direction equirectangular(real x, real y, scene_data scene, int k)
{
  real level, ahead, aside = azimuth_of_column(x, scene, k, &ahead);
  real up = sin_cos(above_middle(y, REAL(C(3.14159265358979324)) / number(scene, k + CAMERA_HEIGHT), scene, k), &level);
  return camera_direction(level * aside, up, level * ahead, scene, k);
}
