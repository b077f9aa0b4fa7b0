// slope.h - two paints of one surface, such as grass and rock: how much of the first, by how the surface slopes at the point q?
// Numbers: the cosine of the slope at which both are alike; over how much of the cosine they blend; the unit vector up. All in the
// frame of the object, as the gradient is.
FN real share_of_flat(point q, covector gradient, scene_data scene, int k)
{
  direction normal = pull_covector(q, gradient);
  real cosine = dot_3(normal, three_numbers(scene, k + 2)) * rsqrt(dot_3(normal, normal));
  real t = fma(cosine - number(scene, k), REAL(1) / number(scene, k + 1), REAL(C(0.5)));
  t = SELECT(t > REAL(0), SELECT(t < REAL(1), t, REAL(1)), REAL(0));
  return t * t * fma(t, REAL(-2), REAL(3));
}

FN real3_lanes slope(surface s, point q, real3_lanes flat, real3_lanes steep, scene_data scene, int k)
{
  real share = share_of_flat(q, s.gradient, scene, k);
  return add_scaled_3(scale_3(steep, REAL(1) - share), flat, share);
}
