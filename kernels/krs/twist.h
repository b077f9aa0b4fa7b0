// twist.h - a sequence twisted about its z-axis: T(x) is x turned by rate * z, and what is drawn is the set of x with T(x) in the model
// (KRS paper 5.2; docs/krs.md, "Twist").
//
// METHOD. |T(x) - T(y)| is the distance from y to x turned by k times the height h between them: with r the distance of x from the axis
// and a that from y across it, at most a + k r |h| across and h along it, and so at most L(r) |x - y|, L(r) = (k r + sqrt(k^2 r^2 + 4))/2
// the norm of this shear. As well r may be that of y. So the distance over L is a bound, at the lesser of how far from the axis the point
// and the model reach, which a cylinder of some radius holds; and so is the way to that cylinder. Numbers: rate k, that radius.
FN point twisted(point q, scene_data scene, int k)
{
  real c, s = sin_cos(number(scene, k) * q.z, &c);
  point y = {fma(c, q.x, -s * q.y), fma(s, q.x, c * q.y), q.z, q.w};
  return y;
}

// A bound of the distance at q from the distance d at T(q). Far from the axis that to the cylinder is the longer one.
FN real twist_bound(real d, point q, scene_data scene, int k)
{
  real radius = number(scene, k + 1), axis = sqrt(fma(q.x, q.x, q.y * q.y)), kr = fabs(number(scene, k)) * fmin(axis, radius);
  real bound = REAL(2) * d / (kr + sqrt(fma(kr, kr, REAL(4)))), outside = axis - radius;
  // A NaN is kept.
  return SELECT(outside > bound, outside, bound);
}

// The gradient of f(T(x)) from that of f at y = T(x).
FN covector twist_back(covector g, point q, point y, scene_data scene, int k)
{
  real c, s = sin_cos(number(scene, k) * q.z, &c);
  covector r = {fma(c, g.x, s * g.y), fma(c, g.y, -s * g.x), fma(number(scene, k), fma(g.y, y.x, -g.x * y.y), g.z), REAL(0)};
  return r;
}
