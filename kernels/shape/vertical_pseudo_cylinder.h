// vertical_pseudo_cylinder.h - sol: all pseudo-balls of one radius about the points of the z-axis of the object's own coordinates
// (paper 11.5); near it a solid cylinder.
//
// The nearest of its points is the one at the same height, at sigma with sigma^2 = X^2 + Y^2, X = e^-z x, Y = e^z y. Half the gradient
// of that is (X, Y, Y^2 - X^2), hence |grad sigma|^2 <= 1 + sigma^2: what changes at such a rate takes the distance
// asinh(sigma) - asinh(radius), which is exact in the planes x = 0 and y = 0.
// Coordinates on it: the angle about the axis in turns; the length along it.
FN real vertical_pseudo_cylinder_distance(point q, real radius)
{
  return area_sinh(across_of(pseudo_direction(q))) - area_sinh(radius);
}

FN surface vertical_pseudo_cylinder_surface(point q, real radius)
{
  direction r = pseudo_direction(q);
  covector gradient = {r.x, r.y, (r.y - r.x) * (r.y + r.x), REAL(0)};
  surface s = {vertical_pseudo_cylinder_distance(q, radius), gradient, turns(r.y, r.x), q.z};
  return s;
}
