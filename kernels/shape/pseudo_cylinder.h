// pseudo_cylinder.h - sol: all pseudo-balls of one radius about the points t (a, b, 0) of the object's own coordinates, a horizontal
// one-parameter subgroup (paper 11.5); near it a solid cylinder.
//
// The least pseudo-distance from its points is sigma with sigma^2 = w^2 + z^2, w = (b x - a y)/(b^2 e^2z + a^2 e^-2z)^(1/2). As the
// least of pseudo-distances it changes as slowly as they do (pseudo_ball.h).
// Coordinates on it: the angle about the curve in turns; t of the nearest point on it.

// A point as the subgroup sees it: w; the sine and cosine of the angle between (a, b) and x at the height of the point; t.
typedef struct { real w, sine, cosine, t; } beside;

FN beside beside_subgroup(point q, real a, real b)
{
  real stretch = exp(q.z), x = a / stretch, y = b * stretch, inverse = rsqrt(fma(x, x, y * y));
  beside r = {fma(b, q.x, -a * q.y) * inverse, y * inverse, x * inverse, REAL(0)};
  r.t = fma(q.x / stretch, r.cosine, q.y * stretch * r.sine) * inverse;
  return r;
}

FN real pseudo_cylinder_distance(point q, real radius, real a, real b)
{
  real w = beside_subgroup(q, a, b).w;
  return pseudo_length(sqrt(fma(w, w, q.z * q.z))) - pseudo_length(radius);
}

FN surface pseudo_cylinder_surface(point q, real radius, real a, real b)
{
  beside r = beside_subgroup(q, a, b);
  // Half of that of sigma^2.
  real turning = (r.cosine - r.sine) * (r.cosine + r.sine);
  covector gradient = {r.w * r.sine, -r.w * r.cosine, fma(r.w * r.w, turning, q.z), REAL(0)};
  surface s = {pseudo_cylinder_distance(q, radius, a, b), gradient, turns(q.z, r.w), r.t};
  return s;
}
