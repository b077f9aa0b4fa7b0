// moebius_map.h - conformal maps of R^3, as points, balls and gradients of distances see them (KRS paper 6.2, 6.3, appendices A and C,
// as corrected in docs/krs.md, "Moebius maps").
//
// The map is x -> t + Q (x - p)/|x - p|^2, p its pole and Q a rotation or reflection times k; without a pole a similarity, t + Q x.
// This form has no difference of large numbers, where the coefficients of spheres (alpha, beta, gamma) lose all digits of small ones in
// single precision. Numbers: 1 with a pole, 0 without; p (3); t (3); Q row by row (9); k.
#define MOEBIUS_SIZE 17
typedef struct { real distance_square; direction from_pole; } pole_view;

FN pole_view seen_from_pole(point x, scene_data scene, int k)
{
  pole_view v = {REAL(1), first_3(x)};
  if (scene.numbers[k] > 0) {
    v.from_pole = add_scaled_3(first_3(x), three_numbers(scene, k + 1), REAL(-1));
    v.distance_square = dot_3(v.from_pole, v.from_pole);
  }
  return v;
}

// t + share * Q v
FN point turned_and_moved(direction v, real share, scene_data scene, int k)
{
  point y = {fma(share, dot_3(v, three_numbers(scene, k + 7)), number(scene, k + 4)),
             fma(share, dot_3(v, three_numbers(scene, k + 10)), number(scene, k + 5)),
             fma(share, dot_3(v, three_numbers(scene, k + 13)), number(scene, k + 6)), REAL(1)};
  return y;
}

// The image of x, and by which factor lengths grow there.
FN point moebius_image(point x, real *factor, scene_data scene, int k)
{
  pole_view v = seen_from_pole(x, scene, k);
  real share = REAL(1) / v.distance_square;
  *factor = number(scene, k + 16) * share;
  return turned_and_moved(v.from_pole, share, scene, k);
}

// The image of the ball about *c; where it holds the pole the image is the outside of a ball, and *ok ends.
FN void moebius_ball(point *c, real *radius, mask *ok, scene_data scene, int k)
{
  pole_view v = seen_from_pole(*c, scene, k);
  real power = v.distance_square;
  if (scene.numbers[k] > 0) power = fma(-*radius, *radius, power);
  *ok &= power > REAL(0);
  *c = turned_and_moved(v.from_pole, REAL(1) / power, scene, k);
  *radius *= number(scene, k + 16) / fabs(power);
}

// The gradient of f(image of x) from that of f at the image.
FN covector moebius_pull_back(covector g, point x, scene_data scene, int k)
{
  pole_view v = seen_from_pole(x, scene, k);
  direction r = scale_3(three_numbers(scene, k + 7), g.x);
  r = add_scaled_3(r, three_numbers(scene, k + 10), g.y);
  r = add_scaled_3(r, three_numbers(scene, k + 13), g.z);
  real share = REAL(1) / v.distance_square;
  if (scene.numbers[k] > 0) r = add_scaled_3(r, v.from_pole, REAL(-2) * share * dot_3(r, v.from_pole));
  return with_w(scale_3(r, share), REAL(0));
}
