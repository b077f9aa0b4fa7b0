// pseudo_ball.h - sol: sigma <= radius with sigma^2 = e^-2z x^2 + e^2z y^2 + z^2 (paper 11.5), near the origin a ball.
//
// sigma itself bounds no distance. In the frame half the gradient of sigma^2 is (X, Y, z - X^2 + Y^2) with X = e^-z x, Y = e^z y, so
// that with q = X^2 + Y^2 = sigma^2 - z^2 its square is at most sigma^2 + 2 |z| q + q^2, and |grad sigma|^2 <= 1 + c sigma + sigma^2,
// c = 4/sqrt 27. What changes at such a rate takes the distance G(sigma) - G(radius), where G' = (1 + c r + r^2)^(-1/2).
// Coordinates on it: those of a globe, for the direction (X, Y, z).
#define HALF_C C(0.38490017945975052)
// The inverse of sqrt(1 - c^2/4).
#define INVERSE_ROOT C(1.0834726777719228)
FN real pseudo_length(real sigma) { return area_sinh((sigma + REAL(HALF_C)) * REAL(INVERSE_ROOT)); }

// (X, Y, z) of a point.
FN direction pseudo_direction(point q)
{
  real stretch = exp(q.z);
  direction r = {q.x / stretch, q.y * stretch, q.z};
  return r;
}

FN real pseudo_ball_distance(point q, real radius)
{
  direction r = pseudo_direction(q);
  return pseudo_length(sqrt(dot_3(r, r))) - pseudo_length(radius);
}

FN surface pseudo_ball_surface(point q, real radius)
{
  direction r = pseudo_direction(q);
  covector gradient = {r.x, r.y, r.z + (r.y - r.x) * (r.y + r.x), REAL(0)};
  return on_globe(pseudo_ball_distance(q, radius), gradient, r, across_of(r));
}
