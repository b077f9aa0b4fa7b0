// perspective.h - straight lines through one point: a picture plane in the tangent space (paper 3.5).
// Its own number: tan(fov/2), for half of the height.
FN direction perspective(real x, real y, scene_data scene, int k)
{
  real scale = REAL(2) * number(scene, k + CAMERA_OWN) / number(scene, k + CAMERA_HEIGHT);
  return camera_direction(right_of_middle(x, scale, scene, k), above_middle(y, scale, scene, k), REAL(1), scene, k);
}
