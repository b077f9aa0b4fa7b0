// fog_exponential.h - distance fog by the Beer-Lambert law (paper eq. 5.5, 5.6). Numbers: density; colour.
FN real3_lanes fog_exponential(real3_lanes seen, real t, scene_data scene, int k)
{
  real clear = exp(-number(scene, k) * t);
  return add_scaled_3(scale_3(seen, clear), three_numbers(scene, k + 1), REAL(1) - clear);
}
