// sl2.h - the universal cover of SL(2, R) (paper 10), a line over every point of the hyperbolic plane.
//
// Points (x, y, z, w): (x, y, z) on the sheet z = sqrt(1 + x^2 + y^2) of H2, w along the fibre; origin (0, 0, 1, 0). In polar
// coordinates of H2 the metric is d rho^2 + sinh^2 rho d theta^2 + (dw - (cosh rho - 1) d theta)^2, up to the sense of theta.
// Of the group element, in the complex form of SL(2, R),
//   Z = cosh(rho/2) e^{i w/2} = C e^{i w/2},  E = sinh(rho/2) e^{i theta - i w/2} = C f e^{-i w/2},  f = (x + i y)/(1 + z),
//   (Z, E)(Z', E') = (Z Z' + E conj E', Z E' + E conj Z'),  w'' = w + w' + 2 arg(1 + (E/Z) (conj E'/Z')) in the cover,
// so left multiplication by p turns H2 about o by w, then moves it by the transvection o -> (x, y, z), and the fibre
// coordinate gains w and twice the angle of 1 + f conj f', which is that of (1 + z + z' + z'') + i (y x' - x y') with the
// turned x', y' and the result's z'': a real part > 0, without cancellation. The formulas below keep to these coordinates:
// (Z, E) would need a root and a sine at each point, and knows it no better, to EPSILON e^rho like h3. Frames are
// left-invariant, d/dx, d/dy, d/dw at o.
//
// METHOD
//   flow, area density: Stumpff functions of s = T^2 - R^2, T = u_w t/2, R = |(u_x, u_y)| t/2, for elliptic, parabolic and
//     hyperbolic geodesics alike (in place of the cases of paper 10.3 and of the corrected 10.6). The fibre coordinate is
//     4 T + 2 phi with phi the continuous argument of C0 - i T S0, for both signs of T, from one atan of a positive denominator.
//   geodesics from o, w >= 0, unknown psi = -phi: H = 2 T - psi = w/2.
//     H <= ch pi - pi/2 (ch = cosh(rho/2)): psi in (0, pi/2), C0(s) = ch cos psi, T = ch sin psi/S0(s); far up the fibre of a far
//       point the unknown is pi/2 - psi, which is then tiny and has its digits. Newton on 1/(H + 1).
//     elliptic, x = sqrt(s) beyond pi/2: unknown distance q of x from a pole k pi, as in nil; w and pi in two parts.
//   order of geodesics and the fibre through o: twisted.h.
// RANGE. x, y, z overflow at kappa t = 88 in float, 709 in double (kappa^2 = a^2 - c^2). As in h3, coordinates fix a position to
// EPSILON e^rho only.
// ACCURACY (maximal error; tests/test_golden_sl2.py, tests/stability. Directions are rounded to the precision first, and what that does to a
// long geodesic is in these numbers)
//   quantity, from o                                          float     double    relative to
//   flow: x, y, z;  t from 1e-8 to 10                         5.3e-7    1.1e-15   z
//                   t = 20 to 100                             2.1e-5    3.1e-14   z
//                   elliptic, to 10,000                       t EPSILON           the most that z comes to
//         w                                                   1.9e-7    2.7e-16   max(|w|, |u_w t|)
//         direction there;  t < 10 / t < 100                  2.2e-7    2.0e-16   1; 1.7e-6 in float, t < 100
//   transport;  t < 10                                        5.2e-7    8.2e-16   1; 5.7e-6, 2.1e-15 for t < 100
//   distance and lengths of 5 geodesics                       2.8e-7    6.7e-16   itself
//   their directions                                          2.2e-7    4.5e-16   1; near a fold EPSILON^(1/2)
//   area density, off conjugate points, t < 10                3.6e-6    4.9e-15   itself
//                                       t = 20 to 100         1.1e-4    1.7e-13   itself
#define HOMOGENEOUS 5

FN point origin(void) { point o = {REAL(0), REAL(0), REAL(1), REAL(0)}; return o; }

// z from x and y, without overflow before z itself overflows.
FN real sheet_height(real x, real y) { return hypotenuse(hypotenuse(x, y), REAL(1)); }

FN point translate(point p, point q)
{
  real c, s = sin_cos(p.w, &c), x = fma(q.x, c, -q.y * s), y = fma(q.x, s, q.y * c);
  real along = fma(p.x, x, p.y * y), shift = along / (REAL(1) + p.z) + q.z;
  point r = {fma(shift, p.x, x), fma(shift, p.y, y), REAL(0), REAL(0)};
  r.z = sheet_height(r.x, r.y);
  r.w = p.w + q.w + REAL(2) * arc_tangent_2(fma(p.y, x, -p.x * y), REAL(1) + p.z + q.z + r.z);
  return r;
}

// The inverse of p: -x, -y turned back by w.
FN point untranslate(point p, point q)
{
  real c, s = sin_cos(p.w, &c);
  point inverse = {-fma(p.x, c, p.y * s), -fma(p.y, c, -p.x * s), p.z, -p.w};
  return translate(inverse, q);
}

// An isometry whose matrix leads p to q has still to give the fibre coordinate what it gains: twice the angle as in translate, from the
// row of the matrix that makes z; `sense` is -1 where the fibre is turned over.
#define FIBRE_GAIN
FN point with_fibre_gain(point p, point q, real row_x, real row_y, real row_z, real sense)
{
  q.w += REAL(2) * arc_tangent_2(sense * fma(row_y, p.x, -row_x * p.y), REAL(1) + row_z + p.z + q.z);
  return q;
}

// d(translation(p)) applied to a direction; and its transpose applied to a gradient in ambient coordinates.
FN vector velocity(point p, direction u)
{
  real c, s = sin_cos(p.w, &c), x = fma(u.x, c, -u.y * s), y = fma(u.x, s, u.y * c);
  real along = fma(p.x, x, p.y * y), inverse = REAL(1) / (REAL(1) + p.z);
  vector v = {fma(along * inverse, p.x, x), fma(along * inverse, p.y, y), along, fma(fma(p.y, x, -p.x * y), inverse, u.z)};
  return v;
}

// The rate of change of a direction along its geodesic.
FN direction acceleration(direction u)
{
  direction r = {REAL(2) * u.y * u.z, REAL(-2) * u.x * u.z, REAL(0)};
  return r;
}

FN covector gradient_of(point p, covector g)
{
  real c, s = sin_cos(p.w, &c), inverse = REAL(1) / (REAL(1) + p.z);
  real along = fma(fma(g.x, p.x, g.y * p.y), inverse, g.z), turn = g.w * inverse;
  real x = fma(along, p.x, fma(turn, p.y, g.x)), y = fma(along, p.y, fma(-turn, p.x, g.y));
  covector r = {fma(x, c, y * s), fma(y, c, -x * s), g.w, REAL(0)};
  return r;
}

// Translations keep points on the model; isometries that led a ray back do so up to rounding. Rays keep near: no square overflows.
FN point on_model(point p) { return p; }
FN void reproject(point *p, vector *v)
{
  p->z = sqrt(fma(p->x, p->x, fma(p->y, p->y, REAL(1))));
  *v = unit_speed(*v);
}

FN real coordinate_size(point p) { return REAL(1) + fmax(p.z, fabs(p.w)); }

// What the flow and the area density are made of: T in two parts, R^2, s and the Stumpff functions of s.
typedef struct {
  real T, T_low, square, s, c0, s0;
} helix_state;

FN helix_state helix_after(direction u, real t, real tail)
{
  helix_state h;
  real radius = REAL(C(0.5)) * (t + tail), a = sqrt(fma(u.x, u.x, u.y * u.y)), R = a * radius;
  h.T = half_turn(u.z, t, tail, &h.T_low);
  h.square = R * R;
  h.s = (h.T - R) * (h.T + R);
  h.s0 = stumpff(h.s, &h.c0);
  return h;
}

// The endpoint of the geodesic from o with direction *u after arc length t + tail; *u becomes the direction there.
FN point exponential(direction *u, real t, real tail)
{
  helix_state h = helix_after(*u, t, tail);
  real k = (t + tail) * h.s0, real_part = k * h.c0, imaginary = -k * h.T * h.s0, T = fabs(h.T);
  point q = {fma(u->x, real_part, -u->y * imaginary), fma(u->x, imaginary, u->y * real_part), REAL(0), REAL(0)};
  q.z = fma(REAL(2) * h.square * h.s0, h.s0, REAL(1));

  // The argument, past x = sqrt(s) only by what a positive denominator allows: it never jumps.
  mask elliptic = h.s > REAL(0);
  real x = sqrt(fmax(h.s, REAL(0))), turned = h.square * h.s0;
  real above = SELECT(elliptic, turned * h.c0, T * h.s0);
  real below = SELECT(elliptic, fma(x * turned, h.s0, T + x), h.c0);
  real phi = -copysign(x + arc_tangent_2(above, below), h.T);
  q.w = fma(REAL(4), h.T, fma(REAL(2), phi, REAL(4) * h.T_low));

  real c, s = sin_cos_of_sum(REAL(-4) * h.T, REAL(-4) * h.T_low, &c);
  *u = turn_about_fibre(*u, c, s);
  return q;
}

// Parallel transport along the same geodesic, from the frame at o to the frame at its end: rot_z(-4 T) rot_u(t/2).
FN direction transport(direction u, real t, real tail, direction e)
{
  real low, T = half_turn(u.z, t, tail, &low), c, s = sin_cos_of_sum(REAL(-4) * T, REAL(-4) * low, &c);
  return turn_about_fibre(turn_about(u, REAL(C(0.5)) * (t + tail), e), c, s);
}

// Area of the wave front from a point at distance t + tail, per solid angle (paper 10.6 with g1 corrected, collapsed).
SOLVER real area_density(direction u, real t, real tail)
{
  helix_state h = helix_after(u, t, tail);
  real s1 = stumpff_s1(h.s, h.c0, h.s0);
  return REAL(4) * fma(h.T, h.T, h.square) * fabs(h.s0) * fabs(fma(REAL(-4) * h.square, s1, h.s0));
}

// Added to H before its inverse is taken on the branch of the shortest geodesic.
#define POLE_SHIFT 1
// From w/2 = rho + 1 on, psi is more than 3/4 and its complement the better unknown.
#define COMPLEMENT_ABOVE 1

// The branch x < pi/2 at psi = q, or pi/2 - q in lanes of `complement`: s, S0, sine and cosine of psi.
typedef struct {
  real psi, sine, cosine, s, c0, s0;
} low_turn;

FN low_turn low_turn_at(real q, real ch, mask complement)
{
  real c, s = sin_cos(q, &c);
  low_turn t = {SELECT(complement, REAL(QUARTER_TURN) - q, q), SELECT(complement, c, s), SELECT(complement, s, c)};
  t.c0 = ch * t.cosine;

  // From m = 1 - C0 the angle and its sine alike, so that their quotient has no error where both are small.
  real m = REAL(1) - t.c0, size = fabs(m), root = sqrt(size * (REAL(2) - m));
  mask hyperbolic = m < REAL(0);
  real x = REAL(2) * arc_tangent_2(sqrt(size), sqrt(fmax(REAL(2) - m, REAL(0))));
  real y = REAL(2) * area_sinh(sqrt(REAL(C(0.5)) * size)), angle = SELECT(hyperbolic, y, x);
  t.s = SELECT(hyperbolic, -y * y, x * x);
  t.s0 = sine_over(root, angle);
  return t;
}

FN real solve_low_turn(real sg, real ch, real goal, mask complement, mask active, mask *unsolved)
{
  // rho coth(rho/2) - 1 is the slope of H at 0, and H is convex; for the complement, H is about rho tan psi - psi.
  mask far = sg > REAL(TINY);
  real ratio = SELECT(far, area_sinh(SELECT(far, sg, REAL(1))) / SELECT(far, sg, REAL(1)), REAL(1));
  real direct = goal / fma(REAL(2) * ch, ratio, REAL(-1)), other = REAL(2) * ratio * sg / (goal + REAL(QUARTER_TURN));
  real low = SELECT(complement, REAL(QUARTER_TURN - QUARTER_TURN_END), REAL(0));
  newton n = newton_start(fmin(SELECT(complement, other, direct), REAL(QUARTER_TURN)), low, REAL(QUARTER_TURN_END), active);
  for (int step = 0; step < NEWTON_BOUND && ANY(n.active); step++) {
    low_turn t = low_turn_at(n.at, ch, complement);
    real s1 = stumpff_s1(t.s, t.c0, t.s0), T = ch * t.sine / t.s0, excess = fma(REAL(2), T, -t.psi) - goal;
    real slope = fma(REAL(2), (t.c0 - REAL(2) * T * T * s1) / t.s0, REAL(-1));
    slope = SELECT(complement, -slope, slope);
    real e = fmax(excess, REAL(C(-0.5)) * goal) / (goal + REAL(POLE_SHIFT));
    mask below = SELECT(complement, -excess, excess) > REAL(0);
    newton_step(&n, fma(excess, e, excess) / slope, below, fabs(excess) <= REAL(EPSILON) * (REAL(2) * T + t.psi + goal));
  }
  *unsolved |= n.active;
  return n.at;
}

// H - w/2 at distance q from the pole, and its derivative; *size is the sum of the sizes of its terms, for judging rounding.
FN real excess_height(interval i, real sg, real rest, real q, real *slope, real *size)
{
  real c, s = sin_cos(q, &c), x = fma(i.side, q, i.pole), ratio = sg / s, square = ratio * ratio;
  real root = sqrt(REAL(1) + square), at_pole = REAL(2) * x * square / (REAL(1) + root), angle = arc_tangent_2(s * root, c);
  *slope = i.side * fma(REAL(2), root, REAL(-1) / root) - REAL(2) * x * square * c / (s * root);
  *size = at_pole + REAL(2) * q + angle + fabs(rest);
  return fma(i.side, fma(REAL(2), q, -angle), at_pole) - rest;
}

// About the root after a pole, from 2 pole (sqrt(1 + (sg/q)^2) - 1) = rest, as also before it away from the corner; not for rest <= 0.
FN real start_after_pole(real sg, real pole, real rest)
{
  real a = REAL(C(0.5)) * rest / pole;
  return sg * rsqrt(fmax(a * (a + REAL(2)), REAL(TINY)));
}

// The same before a pole, where the rest grows by q and pole sg^2/q^2 = rest + q in the corner.
FN real start_before_pole(real sg, real pole, real rest)
{
  real corner = power_two_thirds(sg * sqrt(pole));
  return SELECT(rest > REAL(0), fmin(corner, start_after_pole(sg, pole, rest)), fmax(-rest, corner));
}

FN helix circle_on_fibre(real pole, real height, real beyond)
{
  real goal = REAL(C(0.5)) * height;
  return circle_helix(sqrt(REAL(C(0.5)) * beyond * fma(REAL(3), pole, goal)), goal + pole);
}

FN real solve_height(interval i, real sg, real rest, real target, real start, mask active, mask *unsolved)
{
  newton n = newton_start(start, i.low, i.high, active);
  for (int step = 0; step < NEWTON_BOUND && ANY(n.active); step++) {
    real slope, size, excess = excess_height(i, sg, rest, n.at, &slope, &size), e = excess / target;
    mask below = SELECT(i.rising, excess, -excess) > REAL(0);
    newton_step(&n, fma(excess, SELECT(i.rising, REAL(0), e), excess) / slope, below, fabs(excess) <= REAL(EPSILON) * size);
  }
  *unsolved |= n.active;
  return n.at;
}

// The index-th shortest geodesic from o to the point over (x, y), with sg = sinh(rho/2), at w + w_low.
SOLVER connection connect(real x, real y, real sg, real w, real w_low, int index)
{
  mask down = w < REAL(0);
  w_low = SELECT(down, -w_low, w_low);
  w = fabs(w);
  real e_x, e_y, goal = REAL(C(0.5)) * w, ch = sqrt(fma(sg, sg, REAL(1)));
  base_direction(x, y, &e_x, &e_y);
  mask on_fibre = REAL(2) * sg <= REAL(AXIS_RATIO) * w, off_fibre = NOT(on_fibre);
  connection found;
  found.unsolved = (mask)(0);

  search s;
  real target;
  mask low = (mask)(0);
  if (index == 0) {
    low = goal <= fma(REAL(PI_HIGH), ch, REAL(-QUARTER_TURN));
    s.i = before_pole(1);
    s.rest = REAL(C(0.5)) * height_beyond(w, w_low, s.i);
    s.start = fmin(start_before_pole(sg, s.i.pole, s.rest), REAL(QUARTER_TURN));
    s.exists = off_fibre;
    target = goal + REAL(POLE_SHIFT);
  } else {
    s = search_interval(index, sg, power_two_thirds(sg), REAL(C(0.5)), w, w_low, off_fibre, &found.unsolved);
    target = goal + REAL((index + 1) / 2 * (scalar)PI_HIGH) + REAL(PI_HIGH);
  }
  found.exists = s.exists;
  real q = solve_height(s.i, sg, s.rest, target, s.start, found.exists & NOT(low), &found.unsolved);

  // Recover the direction (x + i y) e^{i psi}, where e^{i psi} is that of the angle at the pole but for the sign of the sine.
  real cosine, sine = sin_cos(q, &cosine), wide = hypotenuse(sg, sine), angle = arc_tangent_2(wide, cosine);
  helix h = {REAL(2) * sg * fma(s.i.side, q, s.i.pole) / sine, goal + fma(s.i.side, angle, s.i.pole), s.i.side * cosine / ch,
             wide / ch};
  if (index == 0) {
    mask complement = goal > fma(REAL(2), area_sinh(sg), REAL(COMPLEMENT_ABOVE));
    low_turn t = low_turn_at(solve_low_turn(sg, ch, goal, complement, off_fibre & low, &found.unsolved), ch, complement);
    helix below = {REAL(2) * sg / t.s0, goal + t.psi, t.cosine, t.sine};
    h = select_helix(low, below, h);
  }
  h = on_the_fibre(h, index, w, w_low, on_fibre, &found);
  return finish(found, h, e_x, e_y, down);
}

// Beyond this product of heights, and on opposite sides of o, points are so far apart that cosh does not cancel.
#define OPPOSITE_ABOVE 2
// Beyond this |(x, y)|^2 the direction from p to q is split into the part away from o and the part across.
#define SPLIT_DIRECTION_ABOVE 1
// untranslate(p, q) with what precision cut off the inputs, and the geodesic from o to it. In H2 as in h3.h; the angle that the
// fibre coordinate gains has real part 2 + z_p + z_q + (cosh rho - 1), imaginary part x_p d_y - y_p d_x.
SOLVER connection connect_points(point p, point q, point p_tail, point q_tail, int index)
{
  real d_x = (q.x - p.x) + (q_tail.x - p_tail.x), d_y = (q.y - p.y) + (q_tail.y - p_tail.y);
  real z_p = sheet_height(p.x, p.y), z_q = sheet_height(q.x, q.y), total = z_p + z_q;
  real along = fma(p.x, q.x, p.y * q.y), product = fma(z_p, z_q, -along);

  // sinh(rho/2), from the difference at its own scale.
  real size = fmax(fmax(fabs(d_x), fabs(d_y)), REAL(TINY)), a = d_x / size, b = d_y / size;
  mask first = z_p < z_q;
  real short_x = SELECT(first, p.x, q.x), short_y = SELECT(first, p.y, q.y), moment = fma(a, short_y, -b * short_x);
  real near = size * sqrt((moment * moment + fma(a, a, b * b)) / (REAL(2) * (REAL(1) + fma(z_p, z_q, along))));
  mask opposite_far = (along < REAL(0)) & (product > REAL(OPPOSITE_ABOVE));
  real sg = SELECT(opposite_far, sqrt(REAL(C(0.5)) * fmax(product - REAL(1), REAL(0))), near);

  // The direction of q from p in the frame that the transvection carries to p, then turned back by the fibre coordinate of p.
  real d_z = fma(d_x, p.x + q.x, d_y * (p.y + q.y)) / total, shift = fma(p.x, d_x, p.y * d_y) / (REAL(1) + z_p) - d_z;
  real x = fma(shift, p.x, d_x), y = fma(shift, p.y, d_y);
  real r = sqrt(fmax(fma(p.x, p.x, p.y * p.y), REAL(SPLIT_DIRECTION_ABOVE))), n_x = p.x / r, n_y = p.y / r;
  real forward = fma(d_x, n_x, d_y * n_y), sideways = fma(n_x, d_y, -n_y * d_x);
  real ahead = (REAL(2) * forward * total - sideways * sideways * fma(r, total, -forward * z_p)) /
               ((total - forward) * (total + forward));
  mask split = (fma(p.x, p.x, p.y * p.y) > REAL(SPLIT_DIRECTION_ABOVE)) & NOT(along < REAL(0));
  x = SELECT(split, fma(ahead, n_x, -sideways * n_y), x);
  y = SELECT(split, fma(ahead, n_y, sideways * n_x), y);
  real c, s = sin_cos(p.w, &c);

  // The fibre coordinate, in two parts.
  real low, sum_low, w = two_sum(q.w, -p.w, &low);
  real gain = REAL(2) * arc_tangent_2(fma(p.x, d_y, -p.y * d_x), REAL(2) + total + REAL(2) * sg * sg);
  w = two_sum(w, gain, &sum_low);
  low += sum_low + (q_tail.w - p_tail.w);
  // Where the sum cancels, the tails are all that is left.
  w = two_sum(w, low, &low);
  return connect(fma(x, c, y * s), fma(y, c, -x * s), sg, w, low, index);
}

// sinh(rho/2) of a point.
FN real half_sine(point p)
{
  real e_x, e_y, r = base_direction(p.x, p.y, &e_x, &e_y);
  return r / sqrt(REAL(2) * (REAL(1) + p.z));
}

// The distance from o.
FN real origin_distance(point p) { return connect(p.x, p.y, half_sine(p), p.w, REAL(0), 0).length; }

// A lower bound of the distance d from o. Along a curve of unit speed rho and w change by at most sqrt(1 + tanh^2(rho/2))
// together, since |dw| <= |n| + tanh(rho/2) |h| for the parts n along the fibre and h across (paper, lemma 10.4, without the
// part of h that moves neither): so d >= Y/sqrt(1 + tanh^2), Y^2 = rho^2 + w^2, and d <= Y by the curve of constant theta.
// On a shortest curve rho stays below (rho + d)/2. Never below Y/sqrt 2; exact where w = 0, and nearly so near o.
FN real underestimate(point p)
{
  real rho = REAL(2) * area_sinh(half_sine(p)), Y = hypotenuse(rho, p.w);
  real e = exp(REAL(C(-0.5)) * (Y + rho)), slope = (REAL(1) - e) / (REAL(1) + e);
  return fmax(rho, Y * rsqrt(fma(slope, slope, REAL(1))));
}

// The way at constant theta: up along the fibre while going straight out.
FN real overestimate(point p) { return hypotenuse(REAL(2) * area_sinh(half_sine(p)), p.w); }

// Walls over H2. With tau = (t/2) S0/C0, k = sqrt(u_w^2 - a^2), tau = tan(k t/2)/k, and the frame at p turned by its fibre coordinate,
// the geodesic comes to tau/(1 + (k tau)^2) times 2 U - 2 i u_w tau U over H2, at z = 1 + 2 a^2 tau^2/(1 + (k tau)^2): at the wall,
// (2 u_w turning - height) tau^2 + 2 rate tau = height.
FN vector wall_turning(point p, vector v)
{
  direction turned = {v.y, -v.x, REAL(0)};
  return velocity(p, turned);
}
FN real wall_ratio(vector v, real height, real rate, real turning)
{
  return larger_root(height, rate, fma(REAL(2) * v.z, turning, -height));
}
FN real crossing_time(real ratio, vector v)
{
  real a = sqrt(fma(v.x, v.x, v.y * v.y)), c = fabs(v.z);
  return half_angle_time(ratio, (c - a) * (c + a));
}

// The maximum of T (1 - T^2), 2/sqrt 27.
#define MOST_BEND C(0.3849001794597505)
// Before this time w has neither risen by `above` nor fallen by `below` (paper 12.3). With T = tanh(rho/2), U = (h_rho, h_theta) of
// length a and the momentum j = (u_w + T h_theta)/(1 - T^2), which stays, w changes at the rate f = u_w - T h_theta, and f at
//   f_1 = T h_rho (u_w + T h_theta) = j T (1 - T^2) h_rho,   which is at most a (|u_w| + a/2) and |j| a 2/sqrt 27;
// the rate of f_1, (u_w + T h_theta) (a^2 - u_w^2 + (u_w + T h_theta)^2 - 3 (T h_rho)^2)/2, is at most a (a + |u_w|)^2.
FN real level_time(point p, vector v, real above, real below)
{
  vector ambient = velocity(p, first_3(v));
  real f = ambient.w, turning = fma(REAL(2), v.z, -f), f_1 = ambient.z / (REAL(1) + p.z) * turning;
  real a = sqrt(fma(v.x, v.x, v.y * v.y)), c = fabs(v.z), j = REAL(C(0.5)) * fabs(turning) * (REAL(1) + p.z);
  real bend = a * fmin(fma(REAL(C(0.5)), a, c), REAL(MOST_BEND) * j);
  return level_time_bound(f, f_1, bend, a * (a + c) * (a + c), above, below);
}
