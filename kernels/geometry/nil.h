// nil.h - Nil, the Heisenberg group (paper 9), in the model that rotations about the z axis act on linearly.
//
// Points (x, y, z, 1), origin 0; metric dx^2 + dy^2 + (dz - (x dy - y dx)/2)^2. Translation by p is left multiplication,
// (p)(q) = (p_x + q_x, p_y + q_y, p_z + q_z + (p_x q_y - p_y q_x)/2), and -p the inverse. Frames are left-invariant. Fibres
// are the vertical lines; horizontal geodesics project to straight lines, all others to circles.
//
// METHOD
//   flow, area density: Stumpff functions of T^2, T = u_z t/2, R = |(u_x, u_y)| t/2, without cases (in place of paper 9.1, 9.2
//     and of 9.6); T in two parts.
//   geodesics from 0, rho = |(x, y)|, z >= 0: H(T) = 2 T (1 + (rho/2)^2 D/S0^2) = z (paper's chi), with T = pole + side q,
//       pole (rho/(2 sin q))^2 + side 2 q (1 + (rho/2)^2 D(q^2)/S0(q^2)^2) = z - 2 pole,
//     in which nothing cancels; z and pi in two parts. T < pi/2: pole 0, Newton on H, which is convex. All other roots are
//     unknown by their distance q from a pole: Newton on (H + 1/2)^(-1/2), nearly linear there.
//   order of geodesics and the fibre through 0: twisted.h.
// ACCURACY (maximal error; tests/test_golden_nil.py, tests/stability. Directions are rounded to the precision first, and what that does to a
// long geodesic is in these numbers)
//   quantity, from 0                                          float     double    relative to
//   flow: x, y / z;  t from 1e-8 to 1000                      1.7e-7    2.1e-16   t
//         z                                                   2.6e-7    3.3e-16   itself
//         direction there;  t < 20 / t < 1000                 2.9e-7    3.0e-16   1; 3.9e-6 in float, t < 1000
//   transport;  t < 20                                        4.6e-7    8.9e-16   1; t EPSILON/16 at t = 1000
//   distance and lengths of 7 geodesics                       2.0e-7    4.5e-16   itself
//   their directions                                          3.3e-7    4.8e-16   1; near a fold EPSILON^(1/2)
//   area density, off conjugate points (factors > 0.02)       7.7e-6    1.1e-15   itself
#define HOMOGENEOUS 4

FN point origin(void) { point o = {REAL(0), REAL(0), REAL(0), REAL(1)}; return o; }

FN real twist(real a_x, real a_y, real b_x, real b_y) { return REAL(C(0.5)) * fma(a_x, b_y, -a_y * b_x); }

FN point translate(point p, point q)
{
  point r = {fma(p.x, q.w, q.x), fma(p.y, q.w, q.y), fma(p.z, q.w, q.z) + twist(p.x, p.y, q.x, q.y), q.w};
  return r;
}

FN point untranslate(point p, point q)
{
  point inverse = {-p.x, -p.y, -p.z, p.w};
  return translate(inverse, q);
}

// d(translation(p)) applied to a direction; and its transpose applied to a gradient in ambient coordinates.
FN vector velocity(point p, direction u)
{
  vector v = {u.x, u.y, u.z + twist(p.x, p.y, u.x, u.y), REAL(0)};
  return v;
}

// The rate of change of a direction along its geodesic.
FN direction acceleration(direction u)
{
  direction r = {-u.z * u.y, u.z * u.x, REAL(0)};
  return r;
}

FN covector gradient_of(point p, covector g)
{
  real bent = REAL(C(0.5)) * g.z;
  covector r = {fma(-bent, p.y, g.x), fma(bent, p.x, g.y), g.z, REAL(0)};
  return r;
}

// Translations keep points on the model, and the direction is normalised here.
FN point on_model(point p) { return p; }
FN void reproject(point *p, vector *v) { *v = unit_speed(*v); }

FN real coordinate_size(point p) { return REAL(1) + fmax(fmax(fabs(p.x), fabs(p.y)), fabs(p.z)); }

// The endpoint of the geodesic from 0 with direction *u after arc length t + tail; *u becomes the direction there.
FN point exponential(direction *u, real t, real tail)
{
  real low, T = half_turn(u->z, t, tail, &low), c, s = sin_cos_of_sum(T, low, &c);
  real length = t + tail, s0 = sine_over(s, T), d = stumpff_d(T * T, c, s0), radius = REAL(C(0.5)) * length;
  real square = fma(u->x, u->x, u->y * u->y) * radius * radius, k = length * s0;
  direction middle = turn_about_fibre(*u, c, s);
  point q = {k * middle.x, k * middle.y, REAL(2) * fma(T, fma(square, d, REAL(1)), low), REAL(1)};
  *u = turn_about_fibre(middle, c, s);
  return q;
}

// Parallel transport along the same geodesic, from the frame at 0 to the frame at its end: rot_z(2 T) rot_u(-t/2).
FN direction transport(direction u, real t, real tail, direction e)
{
  real low, T = half_turn(u.z, t, tail, &low), c, s = sin_cos_of_sum(REAL(2) * T, REAL(2) * low, &c);
  return turn_about_fibre(turn_about(u, REAL(C(-0.5)) * (t + tail), e), c, s);
}

// Area of the wave front from a point at distance t + tail, per solid angle (paper 9.6, collapsed).
FN real area_density(direction u, real t, real tail)
{
  real low, T = half_turn(u.z, t, tail, &low), c, s = sin_cos_of_sum(T, low, &c);
  real length = t + tail, radius = REAL(C(0.5)) * length, s0 = sine_over(s, T), s1 = stumpff_s1(T * T, c, s0);
  real square = fma(u.x, u.x, u.y * u.y) * radius * radius;
  return REAL(4) * fma(T, T, square) * fabs(s0) * fabs(fma(REAL(-2) * square, s1, s0));
}

// Added to H before its power -1/2 is taken.
#define POLE_SHIFT C(0.5)
#define CUBE_ROOT_HALF C(0.7937005259840998)

// H - z at distance q from the pole, and its derivative; *size is the sum of the sizes of its terms, for judging rounding.
FN real excess_height(interval i, real half_rho, real rest, real q, real *slope, real *size)
{
  real cosine, sine = sin_cos(q, &cosine), s0 = sine_over(sine, q), d = stumpff_d(q * q, cosine, s0);
  real inverse = REAL(1) / s0, a = half_rho * inverse, square = a * a;
  mask poleless = NOT(i.pole > REAL(0));
  real ratio = half_rho / sine, at_pole = SELECT(poleless, REAL(0), i.pole * ratio * ratio);
  real swept = REAL(2) * q * fma(square, d, REAL(1));
  real slope_swept = REAL(2) * fma(square, fma(REAL(-2) * cosine, d * inverse, s0 * s0), REAL(1));
  *slope = fma(i.side, slope_swept, SELECT(poleless, REAL(0), REAL(-2) * at_pole * cosine / sine));
  *size = at_pole + swept + fabs(rest);
  return fma(i.side, swept, at_pole) - rest;
}

// About the root after a pole, from pole (rho/2)^2/q^2 = rest: never beyond it.
FN real start_after_pole(real half_rho, real pole, real rest) { return half_rho * sqrt(pole / fmax(rest, REAL(TINY))); }

FN helix circle_on_fibre(real pole, real height, real beyond)
{
  return circle_helix(REAL(2) * sqrt(pole * beyond), REAL(2) * pole);
}

// About the root before a pole, from pole (rho/2)^2/q^2 = rest + 2 q: within a factor of two or so where q is small.
FN real start_before_pole(real half_rho, real pole, real rest)
{
  real a = half_rho * sqrt(pole), corner = REAL(CUBE_ROOT_HALF) * power_two_thirds(a);
  return SELECT(rest > REAL(0), fmin(corner, a * rsqrt(fmax(rest, REAL(TINY)))), fmax(REAL(C(-0.5)) * rest, corner));
}

// The root q of excess_height = 0 in the interval, by Newton from start.
FN real solve_height(interval i, real half_rho, real rest, real target, real start, mask active, mask *unsolved)
{
  newton n = newton_start(start, i.low, i.high, active);
  for (int step = 0; step < NEWTON_BOUND && ANY(n.active); step++) {
    real slope, size, excess = excess_height(i, half_rho, rest, n.at, &slope, &size);
    real e = excess / target, at_pole = REAL(2) * (target + excess) * e / (sqrt(REAL(1) + e) + REAL(1));
    mask below = SELECT(i.rising, excess, -excess) > REAL(0);
    newton_step(&n, SELECT(i.rising, excess, at_pole) / slope, below, fabs(excess) <= REAL(EPSILON) * size);
  }
  *unsolved |= n.active;
  return n.at;
}

// The index-th shortest geodesic from 0 to (x, y, z + z_low).
SOLVER connection connect(real x, real y, real z, real z_low, int index)
{
  mask down = z < REAL(0);
  z_low = SELECT(down, -z_low, z_low);
  z = fabs(z);
  real e_x, e_y, rho = base_direction(x, y, &e_x, &e_y), half_rho = REAL(C(0.5)) * rho;
  mask on_fibre = rho <= REAL(AXIS_RATIO) * z, off_fibre = NOT(on_fibre);
  connection found;
  found.unsolved = (mask)(0);

  search s;
  if (index == 0) {
    interval first_quarter = after_pole(0);
    first_quarter.rising = NOT(first_quarter.rising);
    s.i = select_interval(z <= REAL(PI_HIGH) * fma(REAL(C(0.5)) * half_rho, half_rho, REAL(1)), first_quarter, before_pole(1));
    s.rest = height_beyond(z, z_low, s.i);
    real from_zero = z / fma(rho * REAL(C(0.16666666666666667)), rho, REAL(2));
    s.start = fmin(SELECT(s.i.rising, from_zero, start_before_pole(half_rho, s.i.pole, s.rest)), REAL(QUARTER_TURN));
    s.exists = off_fibre;
  } else {
    real cube_root_s = REAL(C(0.5)) * power_two_thirds(rho);
    s = search_interval(index, half_rho, cube_root_s, REAL(1), z, z_low, off_fibre, &found.unsolved);
  }
  found.exists = s.exists;
  real q = solve_height(s.i, half_rho, s.rest, z + REAL(POLE_SHIFT), s.start, found.exists, &found.unsolved);

  // Recover the direction (x + i y) e^{-i T}: e^{-i T} is e^{-+i q} but for the sign of the sine.
  real cosine, sine = sin_cos(q, &cosine), T = fma(s.i.side, q, s.i.pole);
  real across = SELECT(s.i.pole > REAL(0), rho * T / sine, rho / sine_over(sine, q));
  helix h = {across, REAL(2) * T, s.i.side * cosine, -sine};
  h = on_the_fibre(h, index, z, z_low, on_fibre, &found);
  return finish(found, h, e_x, e_y, down);
}

// The height of q over p in two parts and its place in the plane: untranslate(p, q) with what precision cut off the inputs.
SOLVER connection connect_points(point p, point q, point p_tail, point q_tail, int index)
{
  real x_low, y_low, z_low, twist_low, a_low, b_low;
  real x = two_sum(q.x, -p.x, &x_low), y = two_sum(q.y, -p.y, &y_low), z = two_sum(q.z, -p.z, &z_low);
  x_low += q_tail.x - p_tail.x;
  y_low += q_tail.y - p_tail.y;
  z_low += q_tail.z - p_tail.z;

  // Twice the twist of p and q - p, not of p and q.
  real a = two_product(p.x, y, &a_low), b = two_product(p.y, x, &b_low), swept = two_sum(a, -b, &twist_low);
  twist_low += (a_low - b_low) + (fma(p.x, y_low, p_tail.x * y) - fma(p.y, x_low, p_tail.y * x));
  real sum_low, height_low, height = two_sum(z, REAL(C(-0.5)) * swept, &sum_low);
  height = two_sum(height, sum_low + fma(REAL(C(-0.5)), twist_low, z_low), &height_low);
  return connect(x + x_low, y + y_low, height, height_low, index);
}

// The distance from 0.
FN real origin_distance(point p) { return connect(p.x, p.y, p.z, REAL(0), 0).length; }

// Where the bound |z| <= f(d) of paper, lemma 9.5, changes its form, in |z|.
#define STRAIGHT_BELOW C(2.449489742783178)    // sqrt 6
#define PARABOLIC_FROM C(6.928203230275509)    // 4 sqrt 3
// A lower bound of the distance from 0. Over minimising geodesics |z| <= f(d), and |z| <= d^2/(2 pi) + pi/2, exact where
// d >= pi on the fibre: sharper than the paper's mean of f's inverse and rho, of which this takes the larger.
FN real underestimate(point p)
{
  real e_x, e_y, rho = base_direction(p.x, p.y, &e_x, &e_y), z = fabs(p.z);
  real middle = sqrt(REAL(12) * (power_two_thirds(REAL(C(0.75)) * fmax(z, REAL(STRAIGHT_BELOW))) - REAL(1)));
  real far = sqrt(REAL(C(3.4641016151377544)) * z);
  real by_lemma = SELECT(z < REAL(STRAIGHT_BELOW), z, SELECT(z < REAL(PARABOLIC_FROM), middle, far));
  real by_circles = sqrt(REAL(2 * PI_HIGH) * fmax(z - REAL(PI_HIGH / 2), REAL(0)));
  return fmax(rho, fmax(by_lemma, by_circles));
}

// The way round the axis: up along the fibre while going straight out.
FN real overestimate(point p) { return hypotenuse(hypotenuse(p.x, p.y), p.z); }

// Walls over the plane. With tau = tan(T)/u_z, T = u_z t/2, the geodesic covers (2 tau U + 2 u_z tau^2 i U)/(1 + u_z^2 tau^2) of the
// plane, U = u_x + i u_y, and comes to the wall where (2 u_z turning - u_z^2 height) tau^2 + 2 rate tau = height.
FN vector wall_turning(point p, vector v)
{
  direction turned = {-v.y, v.x, REAL(0)};
  return velocity(p, turned);
}
FN real wall_ratio(vector v, real height, real rate, real turning)
{
  return larger_root(height, rate, v.z * fma(-v.z, height, REAL(2) * turning));
}
FN real crossing_time(real ratio, vector v) { return half_angle_time(ratio, v.z * v.z); }

// Before this time z has neither risen by `above` nor fallen by `below` (paper 12.3). z changes at the rate f = u_z + (p x U)/2, and f
// at u_z (p . U)/2 = u_z m . U/2, where m = p + i U/u_z leads to p from the centre of its circle and keeps its length.
FN real level_time(point p, vector v, real above, real below)
{
  real f = v.z + twist(p.x, p.y, v.x, v.y), f_1 = REAL(C(0.5)) * v.z * fma(p.x, v.x, p.y * v.y);
  real m_x = fma(v.z, p.x, -v.y), m_y = fma(v.z, p.y, v.x), a_square = fma(v.x, v.x, v.y * v.y);
  real bend = REAL(C(0.5)) * sqrt(a_square * fma(m_x, m_x, m_y * m_y));
  return level_time_bound(f, f_1, bend, fabs(v.z) * bend, above, below);
}
