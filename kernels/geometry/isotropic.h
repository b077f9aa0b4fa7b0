// isotropic.h - the three geometries of constant curvature K = 0, +1, -1 (CURVATURE), behind the contract of every geometry.
//
// Model (paper 7.1-7.3): points p = (x, w) of R^4 with w = 1 (e3), |p| = 1 (s3), |x|^2 - w^2 = -1 and w > 0 (h3); origin
// o = e_w. Isometries are 4x4 matrices. The frame at p is the one that translation(p), the transvection o -> p, carries from
// the origin; a `direction` has its three components in that frame, a `vector` is ambient.
// S and C are the sine and cosine of the curvature: t and 1, sin t and cos t, sinh t and cosh t.
//
// METHOD. No formula splits by regime, and none subtracts nearly equal numbers: directions and differences are formed in the
// frame at a point, where they have their natural size, and not in ambient coordinates, which are e^distance large in h3.
// ACCURACY: see e3.h, s3.h and h3.h; measured by tests/test_golden.py against 25-digit values.
#define HOMOGENEOUS 4
FN point origin(void) { point o = {REAL(0), REAL(0), REAL(0), REAL(1)}; return o; }

// The geodesic flow: p and the unit vector v at p move on by the arc length t.
FN void flow(point *p, vector *v, real t)
{
  real c, s = curved_sine(t, &c);
  point q = add_scaled_4(scale_4(*p, c), *v, s);
  *v = add_scaled_4(scale_4(*v, c), *p, REAL(-CURVATURE) * s);
  *p = q;
}

// d(translation(p)) applied to a direction: the matrix [[1 - K x x^T/(1 + w), x], [-K x^T, w]].
FN vector push(point p, direction u)
{
  real along = dot_3(first_3(p), u);
  return with_w(add_scaled_3(u, first_3(p), REAL(-CURVATURE) * along * inverse_one_plus_w(p)), REAL(-CURVATURE) * along);
}

// The ambient velocity of a direction at p; a gradient in ambient coordinates as a covector at p. Vectors are ambient already.
FN vector velocity(point p, direction u) { return push(p, u); }
FN covector gradient_of(point p, covector ambient) { return ambient; }

// The direction of a vector tangent at p. With <p, v> = 0 the inverse matrix collapses to this.
FN direction pull(point p, vector v) { return add_scaled_3(first_3(v), first_3(p), -v.w * inverse_one_plus_w(p)); }

// A covector (a gradient in ambient coordinates) in the frame at p.
FN direction pull_covector(point p, covector g)
{
  real along = fma(dot_3(first_3(g), first_3(p)), inverse_one_plus_w(p), g.w);
  return add_scaled_3(first_3(g), first_3(p), REAL(-CURVATURE) * along);
}

FN point translate(point p, point q)
{
  real along = dot_3(first_3(p), first_3(q));
  real shift = fma(REAL(-CURVATURE) * along, inverse_one_plus_w(p), q.w);
  return with_w(add_scaled_3(first_3(q), first_3(p), shift), fma(p.w, q.w, REAL(-CURVATURE) * along));
}

FN point opposite(point p) { point q = {-p.x, -p.y, -p.z, p.w}; return q; }

FN point untranslate(point p, point q) { return translate(opposite(p), q); }

// Turn of the frame: translation(b) translation(c) = translation(translate(b, c)) o rotation. The rotation fixes the plane's
// normal x_b x x_c; as a quaternion it is (1 + w_b)(1 + w_c) - K x_b . x_c , K x_b x x_c (product of two transvections in
// Spin(4), SL(2, C)), which has no small difference unless the points are nearly antipodal.
FN direction turn_frame(point b, point c, direction u)
{
  real above = REAL(1) / (inverse_one_plus_w(b) * inverse_one_plus_w(c));
  real scalar_part = fma(REAL(-CURVATURE), dot_3(first_3(b), first_3(c)), above);
  direction axis = scale_3(cross_3(first_3(b), first_3(c)), REAL(CURVATURE));
  // Scaled to size 1 before they are squared: both parts are small near the antipode of o, and large far out in h3.
  real size = fmax(fmax(fabs(scalar_part), fabs(axis.x)), fmax(fabs(axis.y), fabs(axis.z)));
  real scale = REAL(1) / fmax(size, REAL(TINY));
  scalar_part *= scale;
  axis = scale_3(axis, scale);
  real k = REAL(2) / fmax(fma(scalar_part, scalar_part, dot_3(axis, axis)), REAL(TINY));
  direction once = cross_3(axis, u);
  return add_scaled_3(add_scaled_3(u, once, k * scalar_part), cross_3(axis, once), k);
}

// S and C of t + tail, where tail is what single precision cut off t.
FN real curved_sine_of_sum(real t, real tail, real *cosine)
{
  real c, s = curved_sine(t, &c);
  *cosine = fma(REAL(-CURVATURE) * s, tail, c);
  return fma(c, tail, s);
}

// The endpoint of the geodesic from o with direction *u after arc length t + tail; *u becomes the direction there, in the
// frame there: here the same, since frames are carried along these geodesics.
FN point exponential(direction *u, real t, real tail)
{
  real c, s = curved_sine_of_sum(t, tail, &c);
  return with_w(scale_3(*u, s), c);
}

// Parallel transport of e along the same geodesic, from the frame at o to the frame at its end.
FN direction transport(direction u, real t, real tail, direction e) { return e; }

FN real distance_between(point p, point q, point p_tail, point q_tail, mask *unsolved)
{
  *unsolved = (mask)(0);
  return separation(p, q, p_tail, q_tail);
}

// The k-th geodesic from p to q, shortest first. e3, h3: only k = 0. s3: even k the short way, odd k the long way round, each
// with k/2 full turns. To the antipode, and with turns to p itself, every direction is right and e_z is returned.
FN connection connect_points(point p, point q, point p_tail, point q_tail, int k)
{
  connection found;
  real shortest = separation(p, q, p_tail, q_tail);
  direction to = towards(p, q, p_tail, q_tail);
  // Scaled to size 1 before it is squared: nearby points may be nearer than the root of the smallest number.
  real size = fmax(fmax(fabs(to.x), fabs(to.y)), fabs(to.z));
  mask degenerate = NOT(size > REAL(TINY));
  to = scale_3(to, REAL(1) / fmax(size, REAL(TINY)));
  direction any_direction = {REAL(0), REAL(0), REAL(1)};
  to = select_3(degenerate, any_direction, to);
  to = scale_3(to, REAL(1) / sqrt(dot_3(to, to)));
  found.unsolved = (mask)(0);
#if CURVATURE == 1
  int back = k & 1;
  found.u = back ? scale_3(to, REAL(-1)) : to;
  found.length = back ? REAL((k + 1) * C(3.14159265358979324)) - shortest : REAL(k * C(3.14159265358979324)) + shortest;
  found.exists = shortest == shortest;
  // Those lengths are multiples of pi; 0 is none.
  found.family = degenerate & (found.length > REAL(1));
#else
  found.u = to;
  found.length = shortest;
  found.exists = (shortest == shortest) & (shortest < REAL(k == 0 ? INFINITY : -1));
  found.family = found.unsolved;
#endif
  return found;
}

// Area of the wave front from a point at distance t + tail, per solid angle (paper 7.5); light intensity is its inverse.
FN real area_density(direction u, real t, real tail)
{
  real c, s = curved_sine_of_sum(t, tail, &c);
  return s * s;
}

// Bounds of the distance from the origin; here the distance itself is cheap.
FN real underestimate(point p) { return origin_distance(p); }
FN real overestimate(point p) { return origin_distance(p); }

// Walls are linear forms n on the ambient coordinates; n . p < 0 inside. rate = n . v, height = -n . p.
FN vector wall_velocity(point p, vector v) { return v; }
FN real wall_ratio(vector v, real height, real rate, real turning) { return rate / height; }
FN real crossing_time(real ratio, vector v) { return meeting_time(ratio, REAL(1)); }
