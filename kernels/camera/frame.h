// frame.h - what every projection starts from (paper 3.5): places in the picture are (x, y) in pixels from its top left corner.
// Numbers of the buffer from k on: position (4); the camera's right, up and forward as directions in the frame there (9); width
// and height of the picture of one eye in pixels. What a projection has of its own follows.
#define CAMERA_RIGHT 4
#define CAMERA_UP 7
#define CAMERA_FORWARD 10
#define CAMERA_WIDTH 13
#define CAMERA_HEIGHT 14
#define CAMERA_OWN 15

// The unit direction at the camera of a vector by its components to the right, up and forward.
FN direction camera_direction(real right, real up, real forward, scene_data scene, int k)
{
  direction u = scale_3(three_numbers(scene, k + CAMERA_FORWARD), forward);
  u = add_scaled_3(u, three_numbers(scene, k + CAMERA_RIGHT), right);
  u = add_scaled_3(u, three_numbers(scene, k + CAMERA_UP), up);
  return scale_3(u, rsqrt(dot_3(u, u)));
}

// How far a place is to the right of the picture's middle, and above it, times `scale`.
FN real right_of_middle(real x, real scale, scene_data scene, int k)
{
  return (x - REAL(C(0.5)) * number(scene, k + CAMERA_WIDTH)) * scale;
}
FN real above_middle(real y, real scale, scene_data scene, int k)
{
  return (REAL(C(0.5)) * number(scene, k + CAMERA_HEIGHT) - y) * scale;
}
