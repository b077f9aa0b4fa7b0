// capsule.h - all points within a radius of a geodesic segment, as a kernel of a sequence; in the products of a vertical one.
// Numbers: its middle M (4); in e3 the unit vector along it (3), half its length, the radius; in the products half the length, the
// radius; in s3 and h3 the direction along it in the frame at M (3), sine and cosine of half its length, both ends (8), the radius.
// Coordinates: the angle about it in turns, the length along it.
#define KRS_CAPSULE 3
#if HOMOGENEOUS == 5
// As the nearest point of the segment sees it.
FN point from_segment(point x, scene_data scene, int k)
{
  point q = untranslate(four_numbers(scene, k), x);
  real half_length = number(scene, k + 4);
  q.w -= fmin(fmax(q.w, -half_length), half_length);
  return q;
}

FN real krs_capsule_distance(point x, scene_data scene, int k)
{
  return origin_distance(from_segment(x, scene, k)) - number(scene, k + 5);
}

FN surface krs_capsule_surface(point x, scene_data scene, int k)
{
  point c = four_numbers(scene, k), q = from_segment(x, scene, k);
  real arc, ratio = arc_over_sine(q, &arc);
  covector gradient = {-c.x * ratio, -c.y * ratio, REAL(-CURVATURE) * c.z * ratio, q.w};
  surface s = {krs_capsule_distance(x, scene, k), gradient, turns(q.y, q.x), x.w - c.w};
  return s;
}

#else
// The angle in turns about an axis, of a direction across it.
FN real turns_about(direction axis, direction across)
{
  direction e_z = {REAL(0), REAL(0), REAL(1)}, e_x = {REAL(1), REAL(0), REAL(0)};
  direction side = cross_3(axis, select_3(fabs(axis.z) < REAL(C(0.9)), e_z, e_x));
  return turns(dot_3(across, cross_3(axis, side)), dot_3(across, side));
}

#if CURVATURE == 0
// From the nearest point of the segment to x, and how far along that is from the middle.
FN direction from_segment(point x, scene_data scene, int k, real *along)
{
  direction d = {x.x - number(scene, k), x.y - number(scene, k + 1), x.z - number(scene, k + 2)};
  direction axis = three_numbers(scene, k + 4);
  real half_length = number(scene, k + 7);
  *along = dot_3(d, axis);
  return add_scaled_3(d, axis, -fmin(fmax(*along, -half_length), half_length));
}

FN real krs_capsule_distance(point x, scene_data scene, int k)
{
  real along;
  direction d = from_segment(x, scene, k, &along);
  return sqrt(dot_3(d, d)) - number(scene, k + 8);
}

FN surface krs_capsule_surface(point x, scene_data scene, int k)
{
  real along;
  direction d = from_segment(x, scene, k, &along);
  surface s = {krs_capsule_distance(x, scene, k), with_w(d, REAL(0)), turns_about(three_numbers(scene, k + 4), d), along};
  return s;
}

#else
// As the middle of the segment sees it: lengths along the axis and across it as sines, and w.
typedef struct { real along, across_square, w; mask beyond; direction across; } from_axis;
FN from_axis beside_segment(point x, scene_data scene, int k)
{
  point q = untranslate(four_numbers(scene, k), x);
  direction axis = three_numbers(scene, k + 4);
  from_axis f;
  f.along = dot_3(first_3(q), axis);
  f.w = q.w;
  f.across = add_scaled_3(first_3(q), axis, -f.along);
  f.across_square = dot_3(f.across, f.across);
  f.beyond = fabs(f.along) * number(scene, k + 8) > q.w * number(scene, k + 7);
  return f;
}

FN real krs_capsule_distance(point x, scene_data scene, int k)
{
  from_axis f = beside_segment(x, scene, k);
  point exact = {REAL(0), REAL(0), REAL(0), REAL(0)};
  point end = select_4(f.along > REAL(0), four_numbers(scene, k + 13), four_numbers(scene, k + 9));
  mask unsolved;
  real from_end = distance_between(end, x, exact, exact, &unsolved);
#if CURVATURE == 1
  // The sine says little near the circle a quarter turn away.
  real from_line = arc_tangent_2(sqrt(f.across_square), sqrt(fma(f.along, f.along, f.w * f.w)));
#else
  real from_line = arc_of_sine(sqrt(f.across_square));
#endif
  return SELECT(f.beyond, from_end, from_line) - number(scene, k + 17);
}

FN surface krs_capsule_surface(point x, scene_data scene, int k)
{
  from_axis f = beside_segment(x, scene, k);
  point middle = four_numbers(scene, k);
  vector along = push(middle, three_numbers(scene, k + 4));
  point end = select_4(f.along > REAL(0), four_numbers(scene, k + 13), four_numbers(scene, k + 9));
  // The foot on the axis, up to a factor; the gradient is that of the distance from it.
  point foot = add_scaled_4(scale_4(middle, f.w), along, f.along);
  foot = select_4(f.beyond, end, foot);
  covector gradient = {-foot.x, -foot.y, -foot.z, REAL(-CURVATURE) * foot.w};
  surface s = {krs_capsule_distance(x, scene, k), gradient, turns_about(three_numbers(scene, k + 4), f.across),
               axis_length(f.along, f.across_square, f.w)};
  return s;
}
#endif
#endif
