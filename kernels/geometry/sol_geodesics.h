// sol_geodesics.h - all geodesics from 0 to a point of Sol, and its distance (left open in paper 11.6 and 12.2).
//
// THE CONIC. a = e^{-z} u_x, b = e^z u_y and u_z + a x - b y stay along a geodesic, so that u_z at its end is c - a x + b y: every
// geodesic from 0 to (x, y, z) has its direction on (c - a x + b y)^2 = 1 - a^2 e^{2z} - b^2 e^{-2z}. With r = b/a, D = x - r y,
// E = (e^{2z} - 1)(1 - r^2 e^{-2z})/D this is c/a = (D + E)/2, c_end/a = (E - D)/2. One unknown is left, and one equation, Y = y.
// REDUCTION. By the symmetries, and by p -> p^-1, which runs through geodesics backwards: X = x e^{-z/2} >= Y = y e^{z/2} >= 0, z >= 0.
// MIDDLE. Sums and differences of Jacobi's functions at both ends give them at the half phase v without any inversion:
//     Q = D/((1 + e^z) + r (1 + e^-z)),  k^2 sn^2 v = (tanh^2(z/2) + Q^2)/(1 + Q^2),  dn^2 v = 1/(cosh^2(z/2)(1 + Q^2)),
//     k cn v = dn u sqrt(F^2 + G^2 dn^2 v),  F = E/((1 + e^z) + r (1 + e^-z)),  G = (1 - r e^-z)/(1 + r e^-z),
// and at the middle u: k cn u = Q dn v/sn v, k sn u = -tanh(z/2)/sn v. So v = sn v R_F, and with the direction (A, B, .) there,
//     b Y = (2 B^2/mu) (sn v cosh^2(z/2) + (2/mu^2) (A sn v/(dn v + cn v))^2 sn v cosh z + (2 A^2/mu^2) I(v)),
// a sum of positive terms; past half a period that is taken off first. The length 2 v/mu - 2 b (Y - y) is stationary.
// UNIQUE, MORE. The shortest is the one with less than a period (Coiculescu, Schwartz: The spheres of Sol); found by regula falsi and
// the secant in log w, where r y = w/(1 + ...), along which log(Y/y) is nearly straight. With n whole periods more, Y - y has one
// minimum on either part of the conic, D > 0 and D < 0, and a root on either side of it where it is negative (measured, not proven);
// lengths with n are below those with n + 1 (measured). A point of a hyperbolic plane has one geodesic: y' = b e^{-2z} keeps its sign.
// ACCURACY (maximal error; tests/test_golden_sol.py, test_sol_geodesics.py)
//   quantity                                            float     double    relative to
//   distance up to 30                                   6.7e-7    1.8e-15   itself
//   its direction, 99 of 100, up to 8                   5.0e-7    1.0e-15   1
//                             up to 30                  4.8e-6    7.8e-15   1; EPSILON^(1/2) where two geodesics fuse, at the ends of
//                                                                           the cut locus
//   where direction and length lead, up to 14           8.1e-7    1.6e-15   max(1, size of (x, y, z)), in the metric there
//                                    up to 30           9.6e-6    2.0e-14   the same
//   lengths of further ones                             3.0e-7    4.1e-16   itself
//   their directions                                    2.7e-7    3.4e-16   1
//   where these lead                                    3.4e-6    4.4e-15   max(1, size of (x, y, z)), in the metric there

// A point in the reduced domain, and what depends on it alone.
typedef struct {
  real x, y, z, stretch, shrink, tangent, cosh_square, cosh_z, grow, fall, over, far;
  mask reversed, exchanged;
} target;

FN target reduced(real x, real y, real z)
{
  target p;
  p.reversed = z < REAL(0);
  p.z = fabs(z);
  real cosine, sine = sinh_cosh(REAL(C(0.5)) * p.z, &cosine), root = sine + cosine;
  p.stretch = root * root;
  p.shrink = REAL(1) / p.stretch;
  x = fabs(x);
  y = fabs(y);
  p.x = SELECT(p.reversed, p.stretch * x, x);
  p.y = SELECT(p.reversed, p.shrink * y, y);
  p.exchanged = p.y * p.stretch > p.x;
  x = SELECT(p.exchanged, p.stretch * p.y, p.x);
  p.y = SELECT(p.exchanged, p.shrink * p.x, p.y);
  p.x = x;
  real rise = REAL(2) * sine * cosine;
  p.tangent = sine / cosine;
  p.cosh_square = cosine * cosine;
  p.cosh_z = fma(REAL(2) * sine, sine, REAL(1));
  p.grow = REAL(2) * rise * p.stretch;
  p.fall = REAL(2) * rise * p.shrink;
  // X/Y - 1, and g/x with g = (e^{2z} - 1)(X^2/Y^2 - 1).
  p.over = fmax(fma(p.x, p.shrink, -p.y) / p.y, REAL(0));
  p.far = p.grow * ((p.over + REAL(2)) / p.x) * p.over;
  return p;
}

// The direction at 0 of a geodesic of the reduced problem, from those at both of its ends.
FN direction restored(target p, direction start, direction end)
{
  direction exchanged = {end.y, end.x, end.z}, exchanged_end = {start.y, start.x, start.z};
  start = select_3(p.exchanged, exchanged, start);
  end = select_3(p.exchanged, exchanged_end, end);
  direction reversed = {end.x, end.y, -end.z};
  return select_3(p.reversed, reversed, start);
}

// A point of the conic: r, D, E, whether it is behind, with D < 0 or what goes to 0 from there, and whether D is large: then differences
// from x - D = r y keep their digits, and else those from D do.
typedef struct { real r, d, e; mask behind, wide; } conic;

// D is large above this part of x.
#define WIDE_ABOVE C(0.5)
// And 1 - r e^-z keeps its digits for r e^-z below this.
#define APART_BELOW C(0.5)

// That for v = D - g/D, with D < 0 in the lanes `behind` and else D > 0, where w = x - g/x - v > 0. Nothing cancels.
FN conic conic_at(target p, real v, real w, mask behind)
{
  real sum = fabs(v) + hypotenuse(v, REAL(2) * sqrt(p.far) * sqrt(p.x)), large = REAL(C(0.5)) * sum;
  real small = REAL(2) * (p.far / fmax(sum, REAL(TINY))) * p.x;
  mask first = behind ^ (v > REAL(0));
  real d = SELECT(first, large, small), ratio = SELECT(first, small, large);
  conic c;
  c.behind = behind;
  c.d = SELECT(behind, -d, fmin(d, p.x));
  c.r = SELECT(behind, p.x + d, w / (REAL(1) + ratio / p.x)) / p.y;
  c.wide = c.d > REAL(WIDE_ABOVE) * p.x;
  real by_r = p.grow * fma(-c.r * p.shrink, c.r * p.shrink, REAL(1)) / c.d;
  real by_d = fma(p.fall, fma(REAL(2), p.x, -c.d) / (p.y * p.y), SELECT(behind, ratio, -ratio));
  c.e = SELECT(c.wide, by_r, by_d);
  return c;
}

// The geodesic with a direction of the conic that comes to the height z after `windings` whole periods and less than one more: both
// directions, b Y and b y, its length where it is one.
typedef struct { direction start, end; real covered, wanted, length; } arc;

FN arc arc_at(target p, conic q, int windings)
{
  real one = REAL(1), one_half = REAL(C(0.5)), c_a = one_half * (q.d + q.e), r_less = one - q.r;
  real square = fma(r_less, r_less, c_a * c_a), a_square = one / fma(c_a, c_a, fma(q.r, q.r, one)), a = sqrt(a_square);
  invariants i;
  i.m = a_square * q.r;
  real mu_square = fma(REAL(2), i.m, one);
  i.mu = sqrt(mu_square);
  real k_square = a_square * square / mu_square, complement_square = REAL(4) * i.m / mu_square;
  i.k = sqrt(k_square);
  i.complement = sqrt(complement_square);

  real r_fall = q.r * p.shrink, size = fma(q.r, one + p.shrink, one + p.stretch), Q = q.d / size, F = q.e / size;
  real tangent_square = p.tangent * p.tangent, Q_square = Q * Q, both = tangent_square + Q_square, plus = one + Q_square;
  mask apart = (r_fall < REAL(APART_BELOW)) | q.wide;
  real G = SELECT(apart, one - r_fall, p.shrink * q.d / p.y - p.over) / (one + r_fall);
  // The shares of cn u and sn u. After whole periods with z = 0 they are those at the start.
  mask whole = NOT(both > REAL(TINY));
  real share = one / SELECT(whole, fmax(square, REAL(TINY)), both);
  real cn_share = SELECT(whole, r_less * r_less, Q_square) * share, sn_share = SELECT(whole, c_a * c_a, tangent_square) * share;
  real dn_square = one / (p.cosh_square * plus), cn_u = sqrt(k_square * cn_share / p.cosh_square), sn_u = sqrt(k_square * plus * sn_share);
  real dn_u = sqrt(fma(cn_u, cn_u, complement_square)), G_square = G * G * dn_square, F_square = F * F;
  real s_square = both / plus, c_square = (F_square + G_square) * dn_u * dn_u;
  // Next to the straight lines a = b, c = 0 both are rounding, of which the length is free.
  mask straight = NOT(s_square + c_square > REAL(TINY));
  s_square = SELECT(straight, REAL(0), s_square);
  c_square = SELECT(straight, one, c_square);
  real inverse = one / (s_square + c_square), d = sqrt(dn_square);
  phase f;
  f.s = sqrt(s_square * inverse);
  f.c = sqrt(c_square * inverse);
  f.d = d;
  mask past = NOT(q.behind | straight) & (SELECT(G_square < F_square, F, G) < REAL(0));
  real cosh_square = p.cosh_square, cosh_z = p.cosh_z;
  real half_gain = REAL(0), quarter = REAL(0), c = c_a * a;
  if (windings > 0 || ANY(past)) {
    agm mean = agm_of(i.k, fmax(i.complement, REAL(TINY)));
    quarter = mean.quarter;
    half_gain = half_period_gain(i, &mean);
    // Half a period less: K less of the half phase, from (b, a, -c) on.
    real up = p.stretch / q.r, turned = i.complement / d;
    phase less = {f.c / d, turned * f.s, turned, REAL(0), REAL(0)};
    f.s = SELECT(past, less.s, f.s);
    f.c = SELECT(past, less.c, f.c);
    f.d = SELECT(past, less.d, f.d);
    real dn_less = i.complement / dn_u;
    cn_u = SELECT(past, dn_less * sn_u, cn_u);
    dn_u = SELECT(past, dn_less, dn_u);
    cosh_z = SELECT(past, one_half * (up + r_fall), cosh_z);
    cosh_square = SELECT(past, one_half * (one + cosh_z), cosh_square);
  }
  real third, v = f.s * carlson_f_and_d(f.c * f.c, f.d * f.d, &third);
  real excess = k_square * f.s * f.s * f.s * third * REAL(C(0.33333333333333333));
  f.integral = height_integral(v, f.s, f.c, f.d, i.k, i.complement, excess);
  f.ratio = f.s / (f.d + f.c);
  real large = one_half * i.mu * (dn_u + cn_u), small = one_half * i.mu * complement_square / (dn_u + cn_u), two = REAL(2) / mu_square;
  real A = SELECT(q.behind, small, large), B = SELECT(q.behind, large, small), ratio = A * f.ratio;
  real covered = REAL(2) * B * B / i.mu * fma(two * A * A, f.integral, f.s * fma(two * ratio * ratio, cosh_z, cosh_square));
  real turn = half_gain + one_minus(c, a_square * fma(q.r, q.r, one));

  arc found;
  found.start.x = a;
  found.start.y = q.r * a;
  found.start.z = c;
  found.end.x = a * p.stretch;
  found.end.y = q.r * a * p.shrink;
  found.end.z = one_half * (q.e - q.d) * a;
  scalar periods = 2 * windings;
  found.covered = covered + SELECT(past, turn, REAL(0)) + REAL(periods) * (one + half_gain);
  found.wanted = found.start.y * p.y;
  real half_phase = v + SELECT(past, quarter, REAL(0)) + REAL(periods) * quarter;
  found.length = fma(REAL(2), half_phase / i.mu, REAL(-2) * (found.covered - found.wanted));
  return found;
}

FN arc select_arc(mask m, arc a, arc b)
{
  arc r = {select_3(m, a.start, b.start), select_3(m, a.end, b.end), SELECT(m, a.covered, b.covered),
           SELECT(m, a.wanted, b.wanted), SELECT(m, a.length, b.length)};
  return r;
}

// A direction is as exact as log(Y/y), a length as its square.
#define DIRECTION_TOLERANCE (4 * EPSILON)
#ifdef FP64
#define LENGTH_TOLERANCE 1e-9
#else
#define LENGTH_TOLERANCE 2e-4f
#endif

// One unknown a lane between two values where an increasing function has opposite signs. The secant, as long as it halves the value and
// stays inside; else bisection, or regula falsi where the bracket is new.
typedef struct { real at, low, high, value_low, value_high, before, value_before; mask active; } bracket;

FN bracket bracket_from(real at, real low, real high, mask active)
{
  bracket b = {at, low, high, REAL(-1), REAL(1), at, REAL(INFINITY), active};
  return b;
}

// The shortest and the longest step beyond an end that is not known yet.
#define OUTWARD_LEAST C(0.5)
#define OUTWARD_MOST C(4.0)
// A bracket is narrow at this part of 1 and the place.
#define NARROW (2 * EPSILON)
// The value at `at` is known: choose the next place. Ends that are not known yet are infinite.
FN void bracket_step(bracket *b, real value, mask solved)
{
  mask low = value < REAL(0), first = NOT(b->value_before < REAL(INFINITY)), again = NOT(first) & NOT(low ^ (b->value_before < REAL(0)));
  mask gains = first | (fabs(value) <= REAL(C(0.5)) * fabs(b->value_before));
  real slope = (value - b->value_before) / (b->at - b->before);
  slope = SELECT(NOT(first) & (slope > REAL(0)) & (slope < REAL(INFINITY)), slope, REAL(1));
  b->low = SELECT(b->active & low, b->at, b->low);
  b->high = SELECT(b->active & NOT(low), b->at, b->high);
  b->value_low = SELECT(low, value, b->value_low);
  b->value_high = SELECT(low, b->value_high, value);
  mask known = (b->low > REAL(-INFINITY)) & (b->high < REAL(INFINITY));
  real width = SELECT(known, b->high - b->low, REAL(0)), step = value / slope, most = REAL(OUTWARD_MOST);
  real secant = b->at - SELECT(known, step, fmin(fmax(step, -most), most));
  real share = SELECT(again | NOT(gains), REAL(C(0.5)), b->value_low / (b->value_low - b->value_high));
  real outward = b->at - copysign(fmin(fmax(fabs(value), REAL(OUTWARD_LEAST)), most), value);
  mask inside = (secant > b->low) & (secant < b->high) & gains;
  mask narrow = known & (width <= REAL(NARROW) * (REAL(1) + fabs(b->at)));
  b->active &= NOT(solved | narrow);
  b->before = b->at;
  b->value_before = value;
  b->at = SELECT(b->active, SELECT(inside, secant, SELECT(known, fma(share, width, b->low), outward)), b->at);
}

// The shortest geodesic to a point where it is neither next to the z-axis nor to the plane y = 0: where log(Y/y) is below `tolerance`.
// A direction is as exact as that, a length as its square.
FN arc shortest_arc(target p, real covered_per_slope, real tolerance, mask active, mask *unsolved)
{
  // The least of x and (1 + g/x^2) y^2/slope.
  real ratio = p.over / (REAL(1) + p.over), start = fmin(p.x, fma(p.fall * ratio, REAL(2) - ratio, p.y * p.y) / covered_per_slope);
  bracket b = bracket_from(log(start), REAL(-INFINITY), REAL(INFINITY), active);
  arc last;
  mask behind = (mask)(0);
  for (int i = 0; i < NEWTON_BOUND && ANY(b.active); i++) {
    real w = exp(b.at);
    arc found = arc_at(p, conic_at(p, (p.x - p.far) - w, w, behind), 0);
    real value = log(fmax(found.covered / found.wanted, REAL(TINY)));
    mask solved = fabs(value) <= tolerance;
    // On the straight lines a = b, c = 0 the value jumps: what is below is right there.
    last = i == 0 ? found : select_arc(b.active & (solved | (value < REAL(0))), found, last);
    bracket_step(&b, value, solved);
  }
  *unsolved |= b.active;
  return last;
}

// Whole periods that are tried: lists are complete for lengths below 4.44 times this, the shortest period being pi sqrt 2.
#define MOST_WINDINGS 8
// How often the place of the minimum of Y - y is narrowed by the golden ratio: to a 500th.
#define MINIMUM_STEPS 13
#define GOLDEN C(0.6180339887498949)
// Where a root is looked for first, in units of x from the minimum or of the way to the end of the conic.
#define ROOT_START C(0.75)

// Two with the same whole periods whose directions differ by less are one, found from both sides of the kink at v = 0: of straight lines.
#define SAME_DIRECTION (16 * EPSILON)
FN mask same_arc(arc a, arc b)
{
  direction apart = add_scaled_3(a.start, b.start, REAL(-1));
  return fmax(fmax(fabs(apart.x), fabs(apart.y)), fabs(apart.z)) < REAL(SAME_DIRECTION);
}

// The index-th of those with whole periods, from 1 on.
FN arc further_arc(target p, int index, mask active, mask *exists, mask *unsolved)
{
  real end = p.x - p.far, rank_left = REAL(index - 1);
  const direction nothing = {REAL(0), REAL(0), REAL(0)};
  const arc none = {nothing, nothing, REAL(0), REAL(0), REAL(0)};
  arc best = none;
  for (int n = 1; n <= MOST_WINDINGS && ANY(active); n++) {
    arc found[4] = {none, none, none, none};
    mask there[4];
    for (int part = 0; part < 4; part += 2) {
      mask behind = part == 0 ? p.x == p.x : (mask)(0);
      // The minimum over v is near 0, and for z = 0 a kink may be there.
      arc a = arc_at(p, conic_at(p, REAL(0), end, behind), n);
      real middle = REAL(0), least = a.covered - a.wanted;
      mask unknown = active & NOT(least < REAL(0));
      if (ANY(unknown)) {
        // Looked for in the cube root of v: the nearer to 0, the sharper it may be.
        real most = SELECT(behind, p.x, fmin(p.x, REAL(ROOT_START) * end)), low = REAL(-1), high = REAL(1), values[2], places[2], v[2];
        for (int step = 0; step < MINIMUM_STEPS; step++) {
          for (int k = 0; k < 2; k++) {
            places[k] = fma(REAL(k == 0 ? 1 - GOLDEN : GOLDEN), high - low, low);
            v[k] = most * places[k] * places[k] * places[k];
            a = arc_at(p, conic_at(p, v[k], end - v[k], behind), n);
            values[k] = a.covered - a.wanted;
          }
          mask left = values[0] < values[1];
          real lesser = SELECT(left, values[0], values[1]);
          mask better = unknown & (lesser < least);
          middle = SELECT(better, SELECT(left, v[0], v[1]), middle);
          least = SELECT(better, lesser, least);
          high = SELECT(left, places[1], high);
          low = SELECT(left, low, places[0]);
        }
      }
      mask negative = active & (least < REAL(0));
      for (int way = 0; way < 2; way++) {
        // Up to the end of the conic, or without end.
        real sign = REAL(way == 0 ? -1 : 1), most = way == 0 ? REAL(INFINITY) : SELECT(behind, REAL(INFINITY), (end - middle) / p.x);
        bracket b = bracket_from(REAL(ROOT_START) * fmin(most, REAL(1)), REAL(0), most, negative);
        b.value_low = least;
        b.value_high = REAL(2 * n);
        for (int i = 0; i < NEWTON_BOUND && ANY(b.active); i++) {
          real v = fma(sign * p.x, b.at, middle);
          a = arc_at(p, conic_at(p, v, end - v, behind), n);
          real value = a.covered - a.wanted;
          found[part + way] = select_arc(b.active, a, found[part + way]);
          bracket_step(&b, value, fabs(value) <= REAL(DIRECTION_TOLERANCE) * a.covered);
        }
        there[part + way] = negative;
        *unsolved |= b.active;
      }
    }
    for (int k = 1; k < 4; k++)
      for (int other = 0; other < k; other++) there[k] &= NOT(there[other] & same_arc(found[k], found[other]));
    real count = REAL(0);
    for (int k = 0; k < 4; k++) {
      real rank = REAL(0);
      for (int other = 0; other < 4; other++) {
        mask before = there[other] & (other < k ? found[other].length <= found[k].length : found[other].length < found[k].length);
        rank += SELECT(before, REAL(1), REAL(0));
      }
      mask chosen = active & there[k] & (rank == rank_left);
      best = select_arc(chosen, found[k], best);
      *exists |= chosen;
      count += SELECT(there[k], REAL(1), REAL(0));
    }
    active &= NOT(*exists) & (count > REAL(0));
    rank_left -= count;
  }
  return best;
}

// Next to the z-axis, for X below this, the exponential map is linear up to a part X. It keeps squares from vanishing.
#ifdef FP64
#define AXIS_BELOW 1e-18
#else
#define AXIS_BELOW 1e-10f
#endif

// In the plane y = 0 the geodesic to (x, z): its length, its direction at 0, and how fast y at its end grows with b/a;
// cosh - 1 of that length.
typedef struct { real length, slope, excess; direction start; } planar;

FN planar planar_to(target p)
{
  real h = fma(p.x, p.x, p.grow) / (REAL(2) * p.x), one = REAL(1), inverse = one / fma(h, h, one), a = sqrt(inverse);
  // cosh of the sum of the parameters of both ends, whose difference the length is.
  real sum;
  sinh_cosh(area_sinh_odd((p.x - h) * p.shrink) - area_sinh(h), &sum);
  planar found;
  found.excess = fma(REAL(C(0.5)) * p.x, p.x * p.shrink, REAL(2) * p.tangent * p.tangent * p.cosh_square);
  found.length = arc_of_excess(found.excess);
  found.slope = REAL(C(0.5)) * a * fma(inverse * sum, sqrt(found.excess * (REAL(2) + found.excess)), inverse * found.length);
  found.start.x = a;
  found.start.y = REAL(0);
  found.start.z = h * a;
  return found;
}

// The index-th geodesic from 0 to (x, y, z), the shortest for index 0.
SOLVER connection connect(real x, real y, real z, int index, real tolerance)
{
  target p = reduced(x, y, z);
  connection found;
  mask further = (mask)(0);
  found.unsolved = (mask)(0);
  planar flat = planar_to(p);
  direction start = flat.start, end;
  start.y = start.x * p.y / flat.slope;
  // Next to the plane (k' e^v)^2 = 4 a b e^length is what is neglected.
  real planar_size = REAL(8) * start.x * start.y * (REAL(1) + flat.excess);
  mask axis = NOT(p.x * p.x > REAL(AXIS_BELOW) * REAL(AXIS_BELOW) * p.stretch);
  mask open = NOT(axis) & (planar_size > REAL(PLANAR_BELOW) * REAL(PLANAR_BELOW));
  end.x = start.x * p.stretch;
  end.y = start.y * p.shrink;
  end.z = fma(-start.x, p.x, start.z);
  found.length = flat.length;
  if (ANY(open)) {
    arc a = index == 0 ? shortest_arc(p, flat.slope, tolerance, open, &found.unsolved) : further_arc(p, index, open, &further, &found.unsolved);
    mask taken = index == 0 ? open : further;
    start = select_3(taken, a.start, start);
    end = select_3(taken, a.end, end);
    found.length = SELECT(taken, a.length, found.length);
  }
  if (ANY(axis)) {
    real rise = REAL(2) * p.tangent * p.cosh_square;
    real ratio = SELECT(rise > REAL(TINY), p.z / SELECT(rise > REAL(TINY), rise, REAL(1)), REAL(1));
    direction to = {p.x * p.shrink * ratio, p.y * p.stretch * ratio, p.z};
    // Scaled to size 1 before it is squared.
    real size = fmax(fmax(to.x, to.y), to.z);
    mask nowhere = NOT(size > REAL(0));
    to = scale_3(to, REAL(1) / SELECT(nowhere, REAL(1), size));
    to.z = SELECT(nowhere, REAL(1), to.z);
    real length = sqrt(dot_3(to, to));
    to = scale_3(to, REAL(1) / length);
    direction after = {to.x * p.stretch, to.y * p.shrink, to.z};
    start = select_3(axis, to, start);
    end = select_3(axis, after, end);
    found.length = SELECT(axis, size * length, found.length);
  }
  start = restored(p, start, end);
  found.u.x = copysign(start.x, x);
  found.u.y = copysign(start.y, y);
  found.u.z = start.z;
  found.u = scale_3(found.u, rsqrt(dot_3(found.u, found.u)));
  real sum = x + y + z;
  found.length = SELECT(sum == sum, found.length, sum);
  found.exists = index == 0 ? sum == sum : further;
  found.family = (mask)(0);
  return found;
}

// untranslate(p, q) with what precision cut off the inputs.
FN real3_lanes difference(point p, point q, point p_tail, point q_tail)
{
  real stretch = exp(p.z);
  real3_lanes d = {((q.x - p.x) + (q_tail.x - p_tail.x)) / stretch, stretch * ((q.y - p.y) + (q_tail.y - p_tail.y)),
                   (q.z - p.z) + (q_tail.z - p_tail.z)};
  return d;
}

SOLVER connection connect_points(point p, point q, point p_tail, point q_tail, int index)
{
  real3_lanes d = difference(p, q, p_tail, q_tail);
  return connect(d.x, d.y, d.z, index, REAL(DIRECTION_TOLERANCE));
}

FN real origin_distance(point p) { return connect(p.x, p.y, p.z, 0, REAL(LENGTH_TOLERANCE)).length; }
