// perspective.h - the direction through a point of the picture (paper 3.5). (x, y) in pixels from the top left corner.
// Numbers: position (4); the camera's right, up and forward as directions in the frame there (9); tan(fov/2) for the height;
// width and height of the whole picture in pixels.
FN direction perspective(real x, real y, scene_data scene, int k)
{
  real scale = REAL(2) * number(scene, k + 13) / number(scene, k + 15);
  real across = (x - REAL(C(0.5)) * number(scene, k + 14)) * scale, upwards = (REAL(C(0.5)) * number(scene, k + 15) - y) * scale;
  direction u = add_scaled_3(three_numbers(scene, k + 10), three_numbers(scene, k + 4), across);
  u = add_scaled_3(u, three_numbers(scene, k + 7), upwards);
  return scale_3(u, rsqrt(dot_3(u, u)));
}
