// s3.h - the three-sphere |p| = 1 of R^4 (paper 7.2), K = +1.
//
// METHOD. Distance is atan2(|p ^ d|, <p, q>) with d = q -+ p: never acos of a number near 1. The w component of d follows
// from <d, q +- p> = 0, since w is the one coordinate that users compute from the others and round.
// ACCURACY (maximal relative error, tests/test_golden.py)
//   points, velocity, transport        float 5.9e-6   double 3.6e-15   (worst near the antipode of o)
//   distance, |w| > 1/8                float 2.5e-7   double 4e-16     also near coincident and near antipodal
//   distance, nearer to the equator    EPSILON |w|/distance: 1.2e-8 in double at 1e-9 apart
//   direction                          7 EPSILON/|x| beyond the equator
//   area density next to its zeros     float 1.4e-5   double 3.1e-16
// The frame at the antipode of o is undefined.
#define CURVATURE 1
FN real curved_sine(real t, real *cosine) { return sin_cos(t, cosine); }
FN real arc_of_sine(real s) { return arc_tangent_2(s, sqrt(fmax((REAL(1) - s) * (REAL(1) + s), REAL(0)))); }
FN real inner(point p, vector a, vector b) { return dot_4(a, b); }

// 1/(1 + w); on the half w < 0 in the form (1 - w)/|x|^2, which does not cancel. The frame is undefined at w = -1 alone.
FN real inverse_one_plus_w(point p)
{
  real3_lanes x = first_3(p);
  mask far = p.w < REAL(0);
  return SELECT(far, REAL(1) - p.w, REAL(1)) / SELECT(far, fmax(dot_3(x, x), REAL(TINY)), REAL(1) + p.w);
}

FN real origin_distance(point p) { return arc_tangent_2(sqrt(dot_3(first_3(p), first_3(p))), p.w); }

// Length along the axis through o of the foot of a point, from its coordinate z along the axis, the square of those across it,
// and w.
FN real axis_length(real z, real across_square, real w) { return arc_tangent_2(z, w); }

// Below this |sum.w| the relation that gives d.w is ill-conditioned and the plain difference is the better one.
#define CHORD_W_FROM_SUM C(0.25)
// The short one of q - p and q + p, and the other one.
FN void chord(point p, point q, point p_tail, point q_tail, real4_lanes *d, real4_lanes *sum)
{
  real sign = SELECT(dot_4(p, q) < REAL(0), REAL(1), REAL(-1));
  *d = add_scaled_4(add_scaled_4(q, p, sign), add_scaled_4(q_tail, p_tail, sign), REAL(1));
  *sum = add_scaled_4(q, p, -sign);
  mask safe = fabs(sum->w) > REAL(CHORD_W_FROM_SUM);
  d->w = SELECT(safe, -dot_3(first_3(*d), first_3(*sum)) / SELECT(safe, sum->w, REAL(1)), d->w);
}

FN real separation(point p, point q, point p_tail, point q_tail)
{
  real4_lanes d, sum;
  chord(p, q, p_tail, q_tail, &d, &sum);
  real back, scale = square_scale(fmax(fmax(fabs(d.x), fabs(d.y)), fmax(fabs(d.z), fabs(d.w))), &back);
  d = scale_4(d, scale);
  real3_lanes spatial = cross_3(first_3(p), first_3(d));
  real3_lanes mixed = add_scaled_3(scale_3(first_3(p), d.w), first_3(d), -p.w);
  return arc_tangent_2(back * sqrt(dot_3(spatial, spatial) + dot_3(mixed, mixed)), dot_4(p, q));
}

// Where q lies from p, in the frame at p, not normalised: the spatial part of untranslate(p, q) = untranslate(p, d) +- o.
FN direction towards(point p, point q, point p_tail, point q_tail)
{
  real4_lanes d, sum;
  chord(p, q, p_tail, q_tail, &d, &sum);
  real along = fma(dot_3(first_3(p), first_3(d)), inverse_one_plus_w(p), d.w);
  return add_scaled_3(first_3(d), first_3(p), -along);
}

// Time until a wall n is crossed at speed l: cos l t (n . p) + (sin l t/l) (n . v) = 0. Every geodesic meets every wall.
FN real meeting_time(real ratio, real l) { return circular_meeting(ratio, l); }

FN real coordinate_size(point p) { return REAL(2); }

// A computed point, put back on the sphere, so that rounding does not add up from flow to flow.
FN point on_model(point p) { return scale_4(p, unit_correction(dot_4(p, p))); }

FN void reproject(point *p, vector *v)
{
  *p = on_model(*p);
  vector tangent = add_scaled_4(*v, *p, -dot_4(*p, *v));
  *v = scale_4(tangent, unit_correction(dot_4(tangent, tangent)));
}
