// h3.h - hyperbolic space: the sheet |x|^2 - w^2 = -1, w > 0 of R^4 (paper 7.3), K = -1.
//
// METHOD. Distance from h = 2 cosh d - 2 formed from the spatial parts, in which nothing cancels; acosh only where the points
// lie on opposite sides of the origin and far apart. Hyperboloid coordinates quantise a position at EPSILON e^distance: keep
// points near the origin by teleporting.
// RANGE. Squares of coordinates overflow at 44 from the origin in float, 354 in double.
// ACCURACY (maximal relative error, tests/test_golden.py; r is the distance from the origin)
//   points, velocity                   float 8e-7     double 2e-15   from the origin to t = 38: 1.4e-7, 3e-15
//   distance, both within r = 3        float 2.1e-7   double 4.3e-16
//   distance, r = 6; 12; 15            float 4.2e-6; 1.7e-3; 1.9e-3   double 4e-16 at any r
//   direction                          float 7 EPSILON w: meaningless beyond r = 12   double 5e-15 to r = 15
#define CURVATURE -1
FN real curved_sine(real t, real *cosine) { return sinh_cosh(t, cosine); }
FN real arc_of_sine(real s) { return area_sinh_odd(s); }
FN real inverse_one_plus_w(point p) { return REAL(1) / (REAL(1) + p.w); }
FN real inner(point p, vector a, vector b) { return fma(-a.w, b.w, dot_3(first_3(a), first_3(b))); }

// asinh |x|, with the sheet's w in place of sqrt(1 + |x|^2).
FN real origin_distance(point p)
{
  real square = dot_3(first_3(p), first_3(p));
  return log_1p(sqrt(square) + square * inverse_one_plus_w(p));
}

FN real height(real3_lanes x) { return sqrt(REAL(1) + dot_3(x, x)); }

// Length along the axis through o of the foot of a point, from its coordinate z along the axis, the square of those across it,
// and w.
FN real axis_length(real z, real across_square, real w) { return arc_of_sine(z * rsqrt(REAL(1) + across_square)); }

FN void chord(point p, point q, point p_tail, point q_tail, real4_lanes *d, real4_lanes *sum)
{
  *d = add_scaled_4(add_scaled_4(q, p, REAL(-1)), add_scaled_4(q_tail, p_tail, REAL(-1)), REAL(1));
  *sum = add_scaled_4(q, p, REAL(1));
  d->w = dot_3(first_3(*d), first_3(*sum)) / sum->w;
}

// a b - c d to the last digits, however nearly equal the products are (Kahan, with fma).
FN real difference_of_products(real a, real b, real c, real d)
{
  real product = c * d, error = fma(-c, d, product);
  return fma(a, b, -product) + error;
}

// p x q of spatial parts. In double the points themselves are exact; in single the difference d has their tails.
FN real3_lanes moment_of(real3_lanes p, real3_lanes q, real3_lanes d)
{
#ifdef FP64
  real3_lanes b = q;
#else
  real3_lanes b = select_3(dot_3(q, q) < dot_3(d, d), q, d);
#endif
  real3_lanes m = {difference_of_products(p.y, b.z, p.z, b.y), difference_of_products(p.z, b.x, p.x, b.z),
                   difference_of_products(p.x, b.y, p.y, b.x)};
  return m;
}

// Beyond this product the points are so far apart that acosh does not cancel.
#define OPPOSITE_ABOVE 2
FN real separation(point p, point q, point p_tail, point q_tail)
{
  real4_lanes d4, sum;
  chord(p, q, p_tail, q_tail, &d4, &sum);
  real3_lanes d = first_3(d4), x_p = first_3(p), x_q = first_3(q);
  real w_p = height(x_p), w_q = height(x_q), along = dot_3(x_p, x_q), product = fma(w_p, w_q, -along);
  // d is scaled to size 1 before it is squared: coordinates reach 1e13 in float.
  real size = fmax(fmax(fabs(d.x), fabs(d.y)), fmax(fabs(d.z), REAL(TINY)));
  real3_lanes moment = scale_3(moment_of(x_p, x_q, d), REAL(1) / size);
  d = scale_3(d, REAL(1) / size);
  real quarter = (dot_3(moment, moment) + dot_3(d, d)) / (REAL(2) * (REAL(1) + fma(w_p, w_q, along)));
  mask opposite_far = (along < REAL(0)) & (product > REAL(OPPOSITE_ABOVE));
  real near_length = REAL(2) * area_sinh(size * sqrt(quarter));
  return SELECT(opposite_far, area_cosh(fmax(product, REAL(OPPOSITE_ABOVE))), near_length);
}

// Beyond this |x|^2 the direction is split into the part along x and the part across.
#define SPLIT_DIRECTION_ABOVE 1
// Where q lies from p, in the frame at p, not normalised: the spatial part of untranslate(p, q).
// Where x_p . x_q < 0 its terms have one sign. Near the origin it is formed from the chord d = q - p. Elsewhere it would
// cancel to EPSILON w^2; split along n = x_p/|x_p|, a = n . d and b^2 = |d - a n|^2, W = w_p + w_q, the part along n is
// (2 a W - b^2 (|x_p| W - a w_p))/((W - a)(W + a)), whose terms are of the size of the result.
FN direction towards(point p, point q, point p_tail, point q_tail)
{
  real4_lanes d4, sum;
  chord(p, q, p_tail, q_tail, &d4, &sum);
  real3_lanes x = first_3(p), x_q = first_3(q), d = first_3(d4);
  real w_q = height(x_q), inverse = inverse_one_plus_w(p), along = dot_3(x, x_q);
  direction opposite_side = add_scaled_3(x_q, x, fma(along, inverse, -w_q));
  direction near_origin = add_scaled_3(d, x, fma(dot_3(x, d), inverse, -d4.w));

  real r = sqrt(fmax(dot_3(x, x), REAL(SPLIT_DIRECTION_ABOVE)));
  real3_lanes n = scale_3(x, REAL(1) / r);
  real a = dot_3(n, d), w_p = height(x), total = w_p + w_q;
  // The part across, (n x d) x n; and W + a = (w_p - r) + w_q + n . x_q, in which r has gone.
  direction across = cross_3(scale_3(moment_of(x, x_q, d), REAL(1) / r), n);
  real total_plus_a = REAL(1) / (w_p + r) + w_q + dot_3(n, x_q);
  real forward = (REAL(2) * a * total - dot_3(across, across) * fma(r, total, -a * w_p)) / ((total - a) * total_plus_a);
  mask split = dot_3(x, x) > REAL(SPLIT_DIRECTION_ABOVE);
  direction same_side = select_3(split, add_scaled_3(across, n, forward), near_origin);
  return select_3(along < REAL(0), opposite_side, same_side);
}

// Time until a wall n is crossed at speed l: cosh l t (n . p) + (sinh l t/l) (n . v) = 0.
FN real meeting_time(real ratio, real l) { return hyperbolic_meeting(ratio, l); }

FN real coordinate_size(point p) { return REAL(1) + p.w; }

// A computed point, put back on the sheet.
FN point on_model(point p) { return with_w(first_3(p), height(first_3(p))); }

// The point on the sheet, and the direction normalised in the frame at p: the ambient product |v_x|^2 - v_w^2 would lose w^2 EPSILON.
// A component of the direction keeps EPSILON |x| of that coordinate as noise. Where that gets to be some percent, at r = 12 and 32,
// the radial part alone, which v.w tells, is nearer to the truth, to sinh(b)/w where the way passes o at the distance b. With noise as
// it is, rays would be thrown back out of the sky.
#define RADIAL_ABOVE C(0.015)
FN real or_radial(real component, real coordinate, real radial)
{
  return SELECT(fabs(coordinate) > REAL(RADIAL_ABOVE / EPSILON), coordinate * radial, component);
}

FN void reproject(point *p, vector *v)
{
  real3_lanes x = first_3(*p);
  *p = on_model(*p);
  real inverse = inverse_one_plus_w(*p), radial = v->w * inverse * inverse;
  direction u = add_scaled_3(first_3(*v), x, -v->w * inverse);
  u.x = or_radial(u.x, x.x, radial);
  u.y = or_radial(u.y, x.y, radial);
  u.z = or_radial(u.z, x.z, radial);
  u = scale_3(u, unit_correction(dot_3(u, u)));
  real along = dot_3(x, u);
  *v = with_w(add_scaled_3(u, x, along * inverse), along);
}
