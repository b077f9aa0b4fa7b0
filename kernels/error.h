// error.h - how far off what a pixel shows may be seen, as an angle: an estimate for each pixel, in the channel "error".
// It is no bound: the root of the area density is the geometric mean of how much two directions across the ray part, which in nil, sl2, sol
// and the products may differ. A ray that is out of steps or came to nothing may be anywhere.
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
  real error = fmin(number(scene, ERROR_CHANNEL) + SELECT(r.hit, grazing, REAL(0)), REAL(HALF_TURN));
  return SELECT(r.spent | NOT(r.t == r.t), REAL(HALF_TURN), error);
}
