// fisheye.h - the equidistant fisheye (azimuthal equidistant projection): the angle from forward grows evenly with the distance from
// the middle, in a circle as wide as the shorter side of the picture. Beyond the circle it goes on alike.
// Its own number: half of the angle of view across the circle.

// The distance of a place from the middle, in radii of the circle, and its parts to the right and up.
FN real radius_of(real x, real y, real *right, real *up, scene_data scene, int k)
{
  real scale = REAL(2) / fmin(number(scene, k + CAMERA_WIDTH), number(scene, k + CAMERA_HEIGHT));
  *right = right_of_middle(x, scale, scene, k);
  *up = above_middle(y, scale, scene, k);
  return sqrt(fma(*right, *right, *up * *up));
}

FN mask in_circle(real x, real y, scene_data scene, int k)
{
  real right, up;
  return radius_of(x, y, &right, &up, scene, k) <= REAL(1);
}

FN direction fisheye(real x, real y, scene_data scene, int k)
{
  real right, up, radius = radius_of(x, y, &right, &up, scene, k), half_angle = number(scene, k + CAMERA_OWN);
  real forward, sine = sin_cos(radius * half_angle, &forward);
  mask middle = NOT(radius > REAL(TINY));
  real share = SELECT(middle, half_angle, sine / SELECT(middle, REAL(1), radius));
  return camera_direction(share * right, share * up, forward, scene, k);
}
