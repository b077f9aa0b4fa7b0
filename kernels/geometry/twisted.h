// twisted.h - what nil and sl2 share: the list of geodesics from the origin o to a point, and how rays come to walls over the plane.
//
// Both fibre over a plane, with rotations about the fibre through o. Geodesics from o to a point at distance rho from that
// fibre and height h >= 0 along it are the roots of an equation H(x) = h, in nil for half the angle x that the geodesic turns
// by, in sl2 for x = sqrt(s) of its elliptic ones (sl2.h): one root before pi, the shortest; in interval k, which is
// (k pi, (k + 1) pi) for k >= 1, none or two, left and right of the minimum of H.
//
// ORDER. Lengths grow with x, so the index-th shortest is known beforehand to be
//     index 0: the root before pi;  index 2 k - 1: left in interval k;  index 2 k: right in interval k.
// One interval is examined for each index, and none of the list is missed. Proof. (a) H(x) - H(x - pi) >= pi: an interval
// without roots is followed by none with; and the left root of interval k + 1, moved back by pi, is short of the right root of
// k (for k = 0: of the shortest, which then is elliptic). (b) Within an interval the two lengths agree where the roots fuse,
// and d(length^2)/dh, which grows with x, is larger at the right root. (c) At fixed h, d(length^2)/d rho is a positive
// multiple of x cot x, the same for all roots. At rho = 0 the right root of k and the left one of k + 1 meet at (k + 1) pi
// with equal lengths; from there to the given rho x cot x stays larger at the left root of k + 1, which is less than pi/2
// beyond its pole, by (a).
//
// ON THE FIBRE THROUGH o every k with 2 k pi < h has a circle of geodesics, of which the one over the x axis is given; any
// rotation of it about the fibre is another. The vertical line, the longest, comes last.

// On the fibre: where rho is below this part of the height. Next to the last circle a direction depends on its cube root.
#ifdef FP64
#define AXIS_RATIO 1e-150
#else
#define AXIS_RATIO 1e-19f
#endif

// Where a root is looked for: at pole + side q with q in (low, high), so near to one of the poles k pi that q has all digits;
// the pole in two parts. H rises with q where `rising`: beyond its minimum, seen from the pole before it.
typedef struct {
  real pole, pole_low, side, low, high;
  mask rising;
} interval;

// A quarter turn, where roots are told apart by the nearer pole, and a little more for the brackets that meet there.
#define QUARTER_TURN C(1.5707963267948966)
#define QUARTER_TURN_END C(1.6)

FN interval after_pole(int n)
{
  scalar high = n * (scalar)PI_HIGH;
  interval i = {REAL(high), REAL(fma((scalar)n, (scalar)PI_HIGH, -high) + n * (scalar)PI_LOW), REAL(1),
                REAL(0), REAL(QUARTER_TURN_END), (mask)(0)};
  return i;
}

FN interval before_pole(int n)
{
  interval i = after_pole(n);
  i.side = REAL(-1);
  return i;
}

FN interval select_interval(mask m, interval a, interval b)
{
  interval i = {SELECT(m, a.pole, b.pole), SELECT(m, a.pole_low, b.pole_low), SELECT(m, a.side, b.side),
                SELECT(m, a.low, b.low), SELECT(m, a.high, b.high), (m & a.rising) | (NOT(m) & b.rising)};
  return i;
}

// What is left of a height in two parts when a geodesic turns by twice the pole.
FN real height_beyond(real height, real low, interval i)
{
  return fma(REAL(-2), i.pole, height) + fma(REAL(-2), i.pole_low, low);
}

// A direction before it is brought to unit length: `across` along (e_x + i e_y)(c + i s), where e is that of the point, and `up`.
typedef struct {
  real across, up, c, s;
} helix;

FN helix circle_helix(real across, real up)
{
  helix h = {across, up, REAL(1), REAL(0)};
  return h;
}

FN helix select_helix(mask m, helix a, helix b)
{
  helix h = {SELECT(m, a.across, b.across), SELECT(m, a.up, b.up), SELECT(m, a.c, b.c), SELECT(m, a.s, b.s)};
  return h;
}

// The geodesic of a helix found for height >= 0, reflected where the height was negative. From a point to itself: e_z.
FN connection finish(connection found, helix h, real e_x, real e_y, mask down)
{
  found.length = hypotenuse(h.across, h.up);
  mask nowhere = NOT(found.length > REAL(0));
  real length = SELECT(nowhere, REAL(1), found.length);
  real across = h.across / length, up = SELECT(nowhere, REAL(1), h.up / length), s = SELECT(down, -h.s, h.s);
  found.u.x = across * fma(e_x, h.c, -e_y * s);
  found.u.y = across * fma(e_x, s, e_y * h.c);
  found.u.z = SELECT(down, -up, up);
  return found;
}

// a^(2/3), for starting values, where a^2 might vanish.
FN real power_two_thirds(real a) { return exp(REAL(C(0.6666666666666667)) * log(a)); }

// The minimum of H in interval k >= 1: the root u in (0, pi/2) of sin^3 u + 2 s (sin u - (k pi + u) cos u), where
// s = rho^2/8 in nil, sinh(rho/2)^2 in sl2. It is monotone; taken apart by s, which may be tiny and is given by s^(1/3).
FN real fold_angle(int k, real cube_root_s, mask active, mask *unsolved)
{
  real pole = REAL(k * (scalar)PI_HIGH), s = cube_root_s * cube_root_s * cube_root_s;
  real start = cube_root_s * exp(REAL(C(0.3333333333333333)) * log(REAL(2) * pole / fma(REAL(2), s, REAL(1))));
  real half_pi = REAL((scalar)PI_HIGH / 2);
  newton n = newton_start(fmin(start, half_pi), REAL(0), half_pi, active);
  for (int i = 0; i < NEWTON_BOUND && ANY(n.active); i++) {
    real cosine, sine = sin_cos(n.at, &cosine), x = pole + n.at, t = sine / cube_root_s;
    real cube = t * t * t, rest = REAL(2) * fma(-x, cosine, sine), value = cube + rest;
    real slope = fma(REAL(3) * t * t / cube_root_s, cosine, REAL(2) * x * sine);
    newton_step(&n, value / slope, value > REAL(0), fabs(value) <= REAL(EPSILON) * (cube + x));
  }
  *unsolved |= n.active;
  return n.at;
}

// What nil.h and sl2.h say of their H. `across` measures rho: half of it in nil, sinh(rho/2) in sl2. H less the rest of the height
// at distance q from a pole, and its derivative, and the sum of the sizes of its terms; where to start on both sides of a pole; the
// circle on the fibre that turns by twice the pole, to a height beyond that.
FN real excess_height(interval i, real across, real rest, real q, real *slope, real *size);
FN real start_after_pole(real across, real pole, real rest);
FN real start_before_pole(real across, real pole, real rest);
FN helix circle_on_fibre(real pole, real height, real beyond);

// Where a root is looked for, what is left of the height there, from where, and in which lanes there is one.
typedef struct {
  interval i;
  real rest, start;
  mask exists;
} search;

// The start in interval k >= 1 is kept below this part of the distance from the pole to the minimum of H.
#define START_BELOW C(0.999)
// For the index-th geodesic, index >= 1. H is the height times `unit`.
FN search search_interval(int index, real across, real cube_root_s, real unit, real height, real low, mask off_fibre, mask *unsolved)
{
  int k = (index + 1) / 2;
  interval left = after_pole(k);
  search found;
  real slope, size;
  found.rest = unit * height_beyond(height, low, left);
  found.exists = off_fibre & (found.rest > REAL(0));
  real fold = fold_angle(k, cube_root_s, found.exists, unsolved);
  found.exists &= excess_height(left, across, found.rest, fold, &slope, &size) <= REAL(0);
  if (index & 1) {
    left.high = fold;
    found.i = left;
    found.start = fmin(start_after_pole(across, left.pole, found.rest), REAL(START_BELOW) * fold);
  } else {
    left.low = fold;
    left.rising = excess_height(left, across, found.rest, REAL(QUARTER_TURN), &slope, &size) >= REAL(0);
    found.i = select_interval(left.rising, left, before_pole(k + 1));
    found.rest = unit * height_beyond(height, low, found.i);
    real from_pole = start_before_pole(across, found.i.pole, found.rest);
    found.start = fmin(SELECT(left.rising, REAL(QUARTER_TURN), from_pole), REAL(QUARTER_TURN));
  }
  return found;
}

// On the fibre: circles of geodesics over poles below the height, then the vertical line; `off` in the other lanes.
FN helix on_the_fibre(helix off, int index, real height, real low, mask on_fibre, connection *found)
{
  interval next = after_pole(index + 1), last = after_pole(index);
  real beyond = height_beyond(height, low, next);
  mask circle = on_fibre & (beyond > REAL(0)), line = on_fibre & NOT(circle);
  if (index > 0) line &= height_beyond(height, low, last) > REAL(0);
  found->exists |= circle | line;
  found->family = circle;
  helix h = select_helix(circle, circle_on_fibre(next.pole, height, fmax(beyond, REAL(0))), off);
  return select_helix(line, circle_helix(REAL(0), height), h);
}

// The unit direction from o over the base point (x, y), and |(x, y)|; e_x and 0 over o and where 1/|(x, y)| overflows.
FN real base_direction(real x, real y, real *e_x, real *e_y)
{
  real size = fmax(fabs(x), fabs(y));
  mask somewhere = size >= REAL(TINY);
  real inverse = REAL(1) / SELECT(somewhere, size, REAL(1)), a = x * inverse, b = y * inverse;
  real norm = SELECT(somewhere, sqrt(fma(a, a, b * b)), REAL(1));
  *e_x = SELECT(somewhere, a / norm, REAL(1));
  *e_y = SELECT(somewhere, b / norm, REAL(0));
  return SELECT(somewhere, size * norm, REAL(0));
}

// Rotations of a direction: about the fibre by the angle with this cosine and sine, about the unit vector n by t.
FN direction turn_about_fibre(direction e, real c, real s)
{
  direction r = {fma(e.x, c, -e.y * s), fma(e.x, s, e.y * c), e.z};
  return r;
}

FN direction turn_about(direction n, real t, direction e)
{
  real c, s = sin_cos(t, &c), half_c, half_s = sin_cos(REAL(C(0.5)) * t, &half_c);
  direction r = add_scaled_3(scale_3(e, c), cross_3(n, e), s);
  return add_scaled_3(r, n, REAL(2) * half_s * half_s * dot_3(n, e));
}

// c (t + tail)/2, half the angle turned, in two parts: a long geodesic turns often, and only the fraction of a turn counts.
FN real half_turn(real c, real t, real tail, real *low)
{
  real rate = REAL(C(0.5)) * c, T = two_product(rate, t, low);
  *low = fma(rate, tail, *low);
  return T;
}

// sin and cos of angle + low.
FN real sin_cos_of_sum(real angle, real low, real *cosine)
{
  real c, s = sin_cos(angle, &c);
  *cosine = fma(-s, low, c);
  return fma(c, low, s);
}

FN vector velocity(point p, direction u);

FN vector wall_velocity(point p, vector v) { return velocity(p, first_3(v)); }

// The larger root r of height r^2 - 2 rate r = A, -INFINITY where there is none; height > 0. A wall over the base is crossed where
// r = k cot(k t/2) (nil.h, sl2.h), which falls with t.
FN real larger_root(real height, real rate, real A)
{
  real square = fma(rate, rate, A * height), root = sqrt(fmax(square, REAL(0)));
  real r = SELECT(rate < REAL(0), A, rate + root) / SELECT(rate < REAL(0), root - rate, height);
  return SELECT(square < REAL(0), REAL(-INFINITY), r);
}

// The time from that ratio, where k^2 is of either sign.
FN real half_angle_time(real ratio, real k_square)
{
  mask circular = k_square > REAL(0);
  real k = sqrt(fabs(k_square));
  real t = SELECT(circular, circular_meeting(ratio, k), hyperbolic_meeting(ratio, k));
  return SELECT(ratio > REAL(-INFINITY), REAL(2) * t, REAL(INFINITY));
}
