// product.h - S2 x E and H2 x E behind the contract of every geometry (paper 8; K = CURVATURE of the factor S2 or H2).
//
// Points are (x, y, z, w): (x, y, z) on the factor, z its time coordinate; w on the line. Isometries are those of the factor
// times those of the line. The frame at p is carried from o by the transvection of the factor and the translation of the
// line; a direction is (along x, along y, along the line). distance^2 is the sum of the squares of both distances.
//
// METHOD. Formulas of the factor are those of isotropic.h on its points (x, y, 0, z), renamed by factor.h. A transvection
// there leaves the third coordinate of a vector alone: the component along the line takes its place. Along a unit direction
// whose factor part has length l, the factor is crossed by the angle l t, with S(l t)/l = t at l = 0: no case of vertical
// directions apart. curved_sine_of_sum, transport (the identity, since frames are carried along) and meeting_time are
// those of isotropic.h.
// ACCURACY: see s2xe.h and h2xe.h.
#undef HOMOGENEOUS
#undef origin
#undef inner
#undef flow
#undef push
#undef pull
#undef pull_covector
#undef velocity
#undef gradient_of
#undef translate
#undef untranslate
#undef turn_frame
#undef exponential
#undef origin_distance
#undef distance_between
#undef connect_points
#undef area_density
#undef underestimate
#undef overestimate
#undef coordinate_size
#undef wall_velocity
#undef wall_ratio
#undef crossing_time
#undef reproject
#undef on_model

#define HOMOGENEOUS 5
FN point origin(void) { point o = {REAL(0), REAL(0), REAL(1), REAL(0)}; return o; }

// The factor's part of a point, as isotropic.h has it; the product's point from it.
FN point factor(point p) { point y = {p.x, p.y, REAL(0), p.z}; return y; }
FN point over(point y, real w) { point p = {y.x, y.y, y.w, w}; return p; }

// A vector or covector as isotropic.h has it at a point of the factor, and back: the component along the line third.
FN vector swapped(vector v) { vector r = {v.x, v.y, v.w, v.z}; return r; }

// A computed point, put back on the model: translations do so already.
FN point on_model(point p) { return p; }

FN real inner(point p, vector a, vector b) { return factor_inner(factor(p), swapped(a), swapped(b)); }

FN vector push(point p, direction u) { return swapped(factor_push(frame_point(factor(p)), u)); }
// The ambient velocity of a direction at p; a gradient in ambient coordinates as a covector at p. Vectors are ambient already.
FN vector velocity(point p, direction u) { return push(p, u); }
FN covector gradient_of(point p, covector ambient) { return ambient; }

FN direction pull(point p, vector v) { return factor_pull(frame_point(factor(p)), swapped(v)); }
FN direction pull_covector(point p, covector g) { return factor_pull_covector(frame_point(factor(p)), swapped(g)); }

FN point translate(point p, point q)
{
  return over(factor_on_model(factor_translate(frame_point(factor(p)), factor(q))), p.w + q.w);
}

FN point untranslate(point p, point q)
{
  return over(factor_on_model(factor_untranslate(frame_point(factor(p)), factor(q))), q.w - p.w);
}

FN direction turn_frame(point b, point c, direction u)
{
  return factor_turn_frame(frame_point(factor(b)), frame_point(factor(c)), u);
}

// S(l t)/l, which is t at l = 0, for time t + tail; *cosine = C(l t).
FN real factor_sine(real l, real t, real tail, real *cosine)
{
  real angle = l * t;
  real s = curved_sine_of_sum(angle, fma(l, tail, fma(l, t, -angle)), cosine);
  mask vertical = NOT(l > REAL(TINY));
  return SELECT(vertical, t + tail, arriving_sine(s, *cosine) / SELECT(vertical, REAL(1), l));
}

FN void flow(point *p, vector *v, real t)
{
  real l = factor_speed(*v), c, s = factor_sine(l, t, REAL(0), &c), w = fma(t, v->w, p->w);
  vector across = {v->x, v->y, REAL(0), v->z};
  point y = add_scaled_4(scale_4(factor(*p), c), across, s);
  across = add_scaled_4(scale_4(across, c), factor(*p), REAL(-CURVATURE) * l * l * s);
  *p = over(y, w);
  *v = over(across, v->w);
}

FN point exponential(direction *u, real t, real tail)
{
  real c, s = factor_sine(sqrt(fma(u->x, u->x, u->y * u->y)), t, tail, &c);
  point q = {s * u->x, s * u->y, c, fma(u->z, t, u->z * tail)};
  return q;
}

FN real origin_distance(point p) { return hypotenuse(factor_origin_distance(factor(p)), p.w); }

// The difference of the line's coordinates, with what single precision cut off them.
FN real rise_between(point p, point q, point p_tail, point q_tail) { return (q.w - p.w) + (q_tail.w - p_tail.w); }

// The start in the factor with a frame (frame_point); what that moves it by goes into its tail, so that the difference to q stays.
FN point framed_start(point p, point p_tail, point *tail)
{
  point start = factor(p), from = frame_point(start);
  *tail = factor(p_tail);
  tail->x += start.x - from.x;
  tail->y += start.y - from.y;
  return from;
}

FN real distance_between(point p, point q, point p_tail, point q_tail, mask *unsolved)
{
  // To the last bit what connect_points finds.
  point from_tail, from = framed_start(p, p_tail, &from_tail);
  real across = factor_distance_between(from, factor(q), from_tail, factor(q_tail), unsolved);
  return hypotenuse(across, rise_between(p, q, p_tail, q_tail));
}

// The k-th geodesic from p to q, shortest first. It covers the k-th of the factor, which isotropic.h gives, while it rises by
// the difference of w; lengths keep that order, since all rise alike. h2xe: only k = 0. s2xe: even k the short way, odd k
// the long way round (paper 8.4 with its sign corrected); over one point, with turns, and over antipodes every direction of S2
// is right and e_x is returned. From a point to itself: the line, with length 0.
FN connection connect_points(point p, point q, point p_tail, point q_tail, int k)
{
  point from_tail, from = framed_start(p, p_tail, &from_tail);
  connection found = factor_connect_points(from, factor(q), from_tail, factor(q_tail), k);
  // Where every direction is right isotropic.h takes its third, which is none of the factor's.
  direction ahead = found.u;
  ahead.x += ahead.z;
  real across = found.length, rise = rise_between(p, q, p_tail, q_tail);
  found.length = hypotenuse(across, rise);
  mask nowhere = NOT(found.length > REAL(TINY));
  real inverse = REAL(1) / SELECT(nowhere, REAL(1), found.length);
  found.u.x = across * ahead.x * inverse;
  found.u.y = across * ahead.y * inverse;
  found.u.z = SELECT(nowhere, REAL(1), rise * inverse);
  return found;
}

// Area of the wave front from a point at time t + tail, per solid angle (paper 8.1 with |sin|): t |S(l t)/l|.
FN real area_density(direction u, real t, real tail)
{
  real c, s = factor_sine(sqrt(fma(u.x, u.x, u.y * u.y)), t, tail, &c);
  return fabs((t + tail) * s);
}

// Bounds of the distance from the origin; here the distance itself is cheap.
FN real underestimate(point p) { return origin_distance(p); }
FN real overestimate(point p) { return origin_distance(p); }

// The coordinate that rounding of positions scales with, and 1.
FN real coordinate_size(point p) { return REAL(1) + fmax(fmax(p.z, REAL(1)), fabs(p.w)); }

// Walls over the factor, as in isotropic.h, at the factor's speed; and walls at levels of the line.
FN vector wall_velocity(point p, vector v) { return v; }
FN real wall_ratio(vector v, real height, real rate, real turning) { return rate / height; }
FN real crossing_time(real ratio, vector v) { return meeting_time(ratio, factor_speed(v)); }

// The time until w has risen by `above` or fallen by `below`.
FN real level_time(point p, vector v, real above, real below)
{
  mask level = NOT(fabs(v.w) > REAL(TINY));
  real left = SELECT(v.w > REAL(0), above, below);
  return SELECT(level, REAL(INFINITY), left / SELECT(level, REAL(1), fabs(v.w)));
}

// Rounding of the flow, undone: the factor's point put back on it, the vector made tangent there and of length 1.
FN void reproject(point *p, vector *v)
{
  point y = factor(*p);
  vector tangent = swapped(*v);
  factor_reproject(&y, &tangent);
  *p = over(y, p->w);
  *v = swapped(tangent);
}
