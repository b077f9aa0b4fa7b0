// triplanar.h - a flat pattern projected along the three axes of the object's frame (KRS paper 8.2): where is a point of the surface in
// each projection, and how much does each count? The gradient is in the object's frame. Number: the length that is one unit of the
// pattern.

// How much the projection along each axis counts: the fourth power of the component of the unit normal, so that on faces across an axis
// there is one, and blends are narrow; in sum 1.
FN direction triplanar_weights(point q, covector gradient)
{
  direction n = pull_covector(q, gradient);
  n = scale_3(n, rsqrt(dot_3(n, n)));
  direction squares = {n.x * n.x, n.y * n.y, n.z * n.z};
  direction powers = {squares.x * squares.x, squares.y * squares.y, squares.z * squares.z};
  return scale_3(powers, REAL(1) / (powers.x + powers.y + powers.z));
}

FN real on_axis(direction a, int axis) { return axis == 0 ? a.x : axis == 1 ? a.y : a.z; }

// The surface as it is seen along an axis, from the side that it faces: up is z, and where one looks along z it is y.
FN surface along_axis(surface s, point q, int axis, scene_data scene, int k)
{
  real size = number(scene, k);
  direction x = {q.y, -q.x, q.x}, y = {q.z, q.z, q.y}, gradient = first_3(s.gradient);
  real right = on_axis(x, axis);
  s.u = SELECT(on_axis(gradient, axis) < REAL(0), -right, right) / size;
  s.v = on_axis(y, axis) / size;
  return s;
}

// What a pixel covers in this projection.
FN footprint footprint_along_axis(footprint f, surface s, point q, int axis, scene_data scene, int k)
{
  direction n = pull_covector(q, s.gradient);
  real size = number(scene, k);
  f.spread = f.area * fabs(on_axis(n, axis)) * rsqrt(dot_3(n, n)) / (size * size);
  return f;
}
