// error.h - how far off what a pixel shows may be seen, as an angle: an estimate for each pixel, in the channel "error".
//
// Number ERROR_CHANNEL of the buffer is the angle within which the method follows geodesics, as measured (benchmarks/accuracy). A ray that
// grazes a surface ends up to the threshold beside it, which is seen under that over the root of the area density.
#define HALF_TURN C(3.14159265358979324)
FN real error_estimate(ray r, scene_data scene)
{
  direction back = pull(r.p, r.v);
  back = scale_3(back, -rsqrt(dot_3(back, back)));
  // The area density of a geodesic is the same both ways.
  real area = fabs(area_density(back, r.t, REAL(0))), grazing = threshold_at(r.t, scene) * rsqrt(fmax(area, REAL(TINY)));
  return fmin(number(scene, ERROR_CHANNEL) + SELECT(r.hit, grazing, REAL(0)), REAL(HALF_TURN));
}
