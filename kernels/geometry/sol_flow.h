// sol_flow.h - the geodesic flow of Sol and parallel transport along it (paper 11.2).
//
// METHOD. Jacobi's functions at half of the phase lead half of the way, and from the direction there the rest, by the addition theorem
// from the initial direction: no phase has to be inverted for, and e^z, e^-z, x and y are sums of terms of one sign. Whole half
// periods are taken off first: each exchanges a and b and turns c round. Planes (m = 0), the vertical and the straight lines a = b,
// c = 0 need no case of their own. Transport: next to a pole +-e_z, the minimal rotation of that onto u turns by 2m/(1 +- u_z)
// besides, which is integrated by Gauss's rule.
// RANGE. In float up to t = 87, in double up to t = 160/mu: further, e^t overflows on the way of what starts next to the vertical, and
// PHASE_END is passed.
// ACCURACY (maximal error; tests/test_golden_sol.py, tests/test_sol_flow.py, tests/stability. Directions and times are rounded to the precision first)
//   quantity, from 0                                    float     double    relative to
//   point, in the metric there;  t from 1e-5 to 100     6.1e-7    1.1e-15   max(1, size of (x, y, z) there); where t < 1, to t
//   direction there;  t <= 3                            7.6e-7    1.1e-15   1
//                     t <= 30                           2.0e-6    4.9e-15   1
//                     t <= 100                          1.7e-5    2.5e-14   1
//   transport;  t <= 1                                  4.6e-7    8.2e-16   1
//               t <= 10                                 2.1e-6    7.0e-15   1
//               t <= 50                                 2.9e-5    2.9e-13   1

// From 0 along (a, b, c), a, b >= 0, by the time v/mu: x and y reached, e^z, e^-z, and the direction there.
typedef struct { real x, y, stretch, shrink; direction u; } leg;

// 1 -+ beta sn, beta = c/mu, comes from the other one where it is less than 1 minus this.
#define BETA_SN_ABOVE C(0.5)
FN leg leg_of(direction u, invariants i, phase p)
{
  real inverse = REAL(1) / i.mu, two = REAL(2) * inverse * inverse, beta_s = u.z * inverse * p.s;
  real sum = u.x + u.y, c_cn = u.z * p.c, n = fma(sum, sum, c_cn * c_cn) * inverse * inverse;
  // 1 - beta sn and 1 + beta sn, whose product is n.
  mask up = beta_s > REAL(BETA_SN_ABOVE), down = -beta_s > REAL(BETA_SN_ABOVE);
  real minus = SELECT(up, n / (REAL(1) + beta_s), REAL(1) - beta_s), plus = SELECT(down, n / (REAL(1) - beta_s), REAL(1) + beta_s);
  real inverse_minus = REAL(1) / minus, inverse_plus = REAL(1) / plus;
  real a_ratio = u.x * p.ratio, b_ratio = u.y * p.ratio, both = p.d + p.c, rs = p.s * p.ratio, one_half = REAL(C(0.5));
  real a_a = u.x * u.x, b_b = u.y * u.y;
  leg r;
  r.stretch = fma(REAL(2) * two * b_b, rs, both) * one_half * inverse_minus;
  r.shrink = fma(REAL(2) * two * a_a, rs, both) * one_half * inverse_plus;
  r.x = u.x * inverse * fma(two * b_b, p.integral, fma(two * p.s * b_ratio, b_ratio * plus, p.s) * inverse_minus);
  r.y = u.y * inverse * fma(two * a_a, p.integral, fma(two * p.s * a_ratio, a_ratio * minus, p.s) * inverse_plus);
  r.u.x = u.x * r.stretch;
  r.u.y = u.y * r.shrink;
  r.u.z = fmin(fmax(fma(c_cn, p.d, -p.s * (u.x - u.y) * sum * inverse) / n, REAL(-1)), REAL(1));
  return r;
}

// Where tanh(z/2) is below this, z comes from it, with all digits also where it is small.
#define HALF_TANGENT_BELOW C(0.5)

// 1 - c for a unit vector, without cancellation.
FN real one_minus(real c, real across_square) { return SELECT(c > REAL(0), across_square / (REAL(1) + c), REAL(1) - c); }

// The endpoint of the geodesic from 0 with direction *u after arc length t + tail; *u becomes the direction there. Not inlined: programs
// would compile a third longer, and rays are 2 to 5 % faster for it only.
SOLVER point exponential(direction *u, real t, real tail)
{
  real length = t + tail, time = fabs(length), back = copysign(REAL(1), length), zero = REAL(0);
  direction start = {fabs(u->x), fabs(u->y), back * u->z}, e = start;
  invariants i = invariants_of(e.x, e.y, e.z);
  real v = REAL(C(0.5)) * i.mu * time, x = zero, y = zero, stretch = REAL(1), shrink = REAL(1);
  mask brief = v < REAL(SHORT_PHASE), whole = (mask)(0);
  phase p = short_phase(v, i.k);
  if (ANY(NOT(brief))) {
    real halves, gain;
    p = select_phase(brief, p, long_phase(i, SELECT(brief, zero, time), &halves, &gain));
    whole = halves > zero;
    if (ANY(whole)) {
      real periods = floor(REAL(C(0.5)) * halves), both = periods * fma(REAL(2), gain, REAL(2)), across = fma(e.x, e.x, e.y * e.y);
      mask odd = halves > REAL(2) * periods;
      x = SELECT(whole, (both + SELECT(odd, gain + one_minus(-e.z, across), zero)) / e.x, zero);
      y = SELECT(whole, (both + SELECT(odd, gain + one_minus(e.z, across), zero)) / e.y, zero);
      stretch = SELECT(odd, e.y / e.x, stretch);
      shrink = SELECT(odd, e.x / e.y, shrink);
      direction exchanged = {e.y, e.x, -e.z};
      e = select_3(odd, exchanged, e);
    }
  }

  leg first = leg_of(e, i, p), second = leg_of(first.u, i, p);
  x = fma(stretch, fma(first.stretch, second.x, first.x), x);
  y = fma(shrink, fma(first.shrink, second.y, first.y), y);
  real tangent = first.u.z * p.s / i.mu;
  mask near = NOT(whole) & (fabs(tangent) < REAL(HALF_TANGENT_BELOW));
  real z = log_1p(REAL(2) * tangent / (REAL(1) - SELECT(near, tangent, zero)));
  if (ANY(NOT(near))) z = SELECT(near, z, log(stretch * first.stretch) + log(second.stretch));

  // What starts in a plane stays in it, though what it is multiplied by may overflow.
  mask flat_x = start.x == zero, flat_y = start.y == zero;
  z = SELECT(flat_x & flat_y, copysign(time, start.z), z);
  point q = {SELECT(flat_x, zero, back * copysign(x, u->x)), SELECT(flat_y, zero, back * copysign(y, u->y)), z, REAL(1)};
  direction arriving = {copysign(second.u.x, u->x), copysign(second.u.y, u->y), back * second.u.z};
  *u = arriving;
  return q;
}

// More steps than this are not made: what they would lead to is not a number.
#define MOST_STEPS 100000
// A step of the quadrature below, and the nodes of Gauss's rule on [0, 1] in it. The first node here is the middle, which says
// about which pole to turn, the last the end; they have no weight.
#ifdef FP64
#define TRANSPORT_STEP 0.25
#define NODES 8
#else
#define TRANSPORT_STEP 0.5f
#define NODES 6
#endif

// A vector turned by the smallest rotation of sign e_z onto the unit vector u, or back by it (way = -1).
FN direction tilt(direction u, real sign, real way, direction e)
{
  direction axis = {-sign * way * u.y, sign * way * u.x, REAL(0)}, once = cross_3(axis, e);
  return add_scaled_3(add_scaled_3(e, once, REAL(1)), cross_3(axis, once), REAL(1) / fma(sign, u.z, REAL(1)));
}

// Parallel transport of e along the same geodesic, from the frame at 0 to the frame at its end: next to a pole, the rotation of that
// onto u turns by the integral of 2m/(1 +- u_z) besides.
FN direction transport(direction u, real t, real tail, direction e)
{
#ifdef FP64
  const scalar node[NODES] = {0.5, 0.033765242898423986, 0.16939530676686774, 0.3806904069584015, 0.6193095930415985,
                              0.8306046932331323, 0.966234757101576, 1.0};
  const scalar weight[NODES] = {0.0, 0.08566224618958517, 0.1803807865240693, 0.23395696728634552, 0.23395696728634552,
                                0.1803807865240693, 0.08566224618958517, 0.0};
#else
  const scalar node[NODES] = {0.5f, 0.0694318442f, 0.3300094782f, 0.6699905218f, 0.9305681558f, 1.0f};
  const scalar weight[NODES] = {0.0f, 0.1739274226f, 0.3260725774f, 0.3260725774f, 0.1739274226f, 0.0f};
#endif
  real length = t + tail, steps = floor(fabs(length) / REAL(TRANSPORT_STEP)) + REAL(1), step = length / steps;
  real rate = REAL(2) * u.x * u.y;
  mask endless = NOT(steps <= REAL(MOST_STEPS));
  steps = SELECT(endless, REAL(0), steps);
  for (int done = 0; done < MOST_STEPS && ANY(REAL(done) < steps); done++) {
    real sign = REAL(1), angle = REAL(0), c;
    direction at;
    for (int n = 0; n < NODES; n++) {
      at = u;
      exponential(&at, REAL(node[n]) * step, REAL(0));
      if (n == 0) sign = copysign(REAL(1), at.z);
      angle = fma(REAL(weight[n]), rate / fma(sign, at.z, REAL(1)), angle);
    }
    at = scale_3(at, unit_correction(dot_3(at, at)));
    real s = sin_cos(sign * angle * step, &c);
    direction upright = tilt(u, sign, REAL(-1), e), turned = {fma(upright.x, c, -upright.y * s), fma(upright.x, s, upright.y * c), upright.z};
    mask active = REAL(done) < steps;
    e = select_3(active, tilt(at, sign, REAL(1), turned), e);
    u = select_3(active, at, u);
  }
  e.x = SELECT(endless, REAL(NAN), e.x);
  return e;
}
