// sky.h - a background that looks like a sky: which color does a ray show that nothing ends?
//
// From the horizon to the zenith, and down to the ground, the color of the horizon fades as (1 - |height|)^4, where the height is
// the sine of the angle above the horizon: half of the change is within 9 degrees of the horizon, as it is in air that is thickest
// along the ground.

// Where the ray of p and v ends at infinity, as the geodesic from the origin to the same point begins: in e3 along v; in h3 towards
// the light-like vector p + v.
FN direction sky_direction(point p, vector v)
{
#if CURVATURE < 0
  real4_lanes end = add_scaled_4(p, v, REAL(1));
  // Of size 1 before it is squared: coordinates are e^distance large.
  direction u = scale_3(first_3(end), REAL(1) / end.w);
#else
  direction u = first_3(v);
#endif
  return scale_3(u, rsqrt(dot_3(u, u)));
}

// Numbers: the colors of zenith, horizon and ground; the unit vector up.
FN real3_lanes sky(point p, vector v, scene_data scene, int k)
{
  real height = dot_3(sky_direction(p, v), three_numbers(scene, k + 9)), left = REAL(1) - fabs(height);
  left *= left;
  real haze = left * left;
  real3_lanes far = select_3(height > REAL(0), three_numbers(scene, k), three_numbers(scene, k + 6));
  return add_scaled_3(scale_3(far, REAL(1) - haze), three_numbers(scene, k + 3), haze);
}
