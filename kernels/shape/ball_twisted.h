// ball_twisted.h - nil, sl2: how far the ball of ball.h is at least and at most (in place of paper 9.6, 10.6).
//
// Let q stand at the height h >= 0 on its fibre, and let G(T) be the least that length^2 - 4 T (rise - h) comes to on the curves
// from o to that fibre. The shortest way to q is one of them, hence G(T) <= d^2 for every T. The least is reached by the geodesic
// with half the angle T that connect of nil.h and sl2.h solves for; it rises to height(T), and G' = 4 (h - height). As height' is
// at least `slope`, d^2 <= G + 2 (height - h)^2/slope. Both bounds are wrong by the square of an error of T: for d < 2 those of the
// first guess differ from d by 3e-4 of it, and after a step of Newton's method by 1e-9.
typedef struct { real square, height, slope; } target;
typedef struct { real least, most, next; } squeeze;

// What the unknown is kept in: s <= COT_END, well before the pole of K(s) = sqrt(s) cot(sqrt(s)) at pi^2.
#define COT_START C(-4.0)
#define COT_END C(7.5625)

// K(s) and two derivatives: the pole, and a polynomial for the rest (Chebyshev on the interval; 6e-9, 8e-18).
FN real root_cot_root(real s, real *first, real *second)
{
#ifdef FP64
  const scalar rest[16] = {-5.22004311821707626e-24, -5.73086350548676153e-23, -3.55211955416432176e-21, -1.411189099111237e-19,
                           -5.50360863382486545e-18, -2.17526875281520742e-16, -8.5920374465053672e-15,  -3.39484368395342418e-13,
                           -1.34284097968211602e-11, -5.32499748596228473e-10, -2.12407018642313037e-8,  -8.59428333220440355e-7,
                           -3.6079169810387032e-5,   -1.6902577128535596e-3,   -0.130690966048657808,    1.0};
#else
  const scalar rest[8] = {-2.03569643e-11f, -5.16372841e-10f, -2.10509582e-8f, -8.60026108e-7f,
                          -3.60808114e-5f,  -1.69025346e-3f,  -0.130690962f,   1.0f};
#endif
  real k = REAL(rest[0]), k1 = REAL(0), k2 = REAL(0);
  for (int i = 1; i < (int)(sizeof(rest) / sizeof(scalar)); i++) {
    k2 = fma(k2, s, k1);
    k1 = fma(k1, s, k);
    k = fma(k, s, REAL(rest[i]));
  }
  real pole = REAL(1) / (REAL(C(9.869604401089358)) - s), slope = REAL(C(-19.739208802178716)) * pole * pole;
  *first = k1 + slope;
  *second = REAL(2) * fma(slope, pole, k2);
  return fma(REAL(-2) * s, pole, k);
}

#if HOMOGENEOUS == 4
FN target target_at(point q)
{
  real square = fma(q.x, q.x, q.y * q.y);
  target a = {square, fabs(q.z), fma(REAL(C(0.16666666666666667)), square, REAL(2))};
  return a;
}

// The unknown is T, its square up to COT_END. Above the root, since height is convex; near the pole about where
// pi rho^2/(2 (pi - T))^2 - 1/2 = h.
#define UNKNOWN_END C(2.75)
FN real first_guess(target a)
{
  real rest = REAL(C(0.886226925452758)) * sqrt(a.square / (a.height + REAL(C(0.5))));
  return fmin(a.height / a.slope, fmin(fmax(REAL(PI_HIGH) - rest, REAL(QUARTER_TURN)), REAL(UNKNOWN_END)));
}

// G = 4 T (h - T) + rho^2 K(T^2), height = 2 T - rho^2 T K'(T^2)/2.
FN squeeze squeeze_at(target a, real T)
{
  real s = T * T, k1, k2, k = root_cot_root(s, &k1, &k2), swept = REAL(C(-0.5)) * a.square;
  real excess = fma(T, fma(swept, k1, REAL(2)), -a.height), least = fma(a.square, k, REAL(4) * T * (a.height - T));
  real next = T - excess / fma(swept, fma(REAL(2) * s, k2, k1), REAL(2));
  squeeze found = {least, fma(REAL(2) * excess, excess / a.slope, least), fmin(fmax(next, REAL(0)), REAL(UNKNOWN_END))};
  return found;
}

#else
FN target target_at(point q)
{
  target a = {fma(q.x, q.x, q.y * q.y) / (REAL(2) * (REAL(1) + q.z)), fabs(q.w), REAL(2)};
  return a;
}

// The unknown is s; with sg = sinh(rho/2) and ch = cosh(rho/2), T^2 = s + sg^2 (K(s)^2 + s) and cos(sqrt(s)) = ch cos psi. At
// first psi is h over the slope of height there, to second order in sg, and s a Pade approximant in 1 - cos(sqrt(s)).
// Beyond it the series of 1 - cos psi below is off by 2 %, and s near COT_END anyway.
#define PSI_END C(2.5)
FN real first_guess(target a)
{
  real ch = sqrt(REAL(1) + a.square), bend = a.square / fma(REAL(C(0.4)), a.square, REAL(1));
  real psi = fmin(a.height / fma(REAL(C(1.3333333333333333)), bend, REAL(2)), REAL(PSI_END)), square = psi * psi;
  real versine = square * fma(square, fma(square, REAL(C(0.001388888888888889)), REAL(C(-0.041666666666666667))), REAL(C(0.5)));
  real m = fma(ch, versine, -a.square / (ch + REAL(1)));
  real s = REAL(2) * m * fma(m, REAL(C(-0.1)), REAL(1)) / fmax(fma(m, REAL(C(-0.26666666666666667)), REAL(1)), REAL(C(0.5)));
  return fmin(fmax(s, REAL(COT_START)), REAL(COT_END));
}

// G = 4 T (h - 2 T + 2 psi) - 4 s, height = 4 T - 2 psi, tan psi = T/K(s). Where T^2 came out negative, which is convex in s, one
// step of Newton's method leads above its zero: G stays a lower bound, and misses the least by less than sg^2 (T^2)^2.
FN squeeze squeeze_at(target a, real s)
{
  real k1, k2, k = root_cot_root(s, &k1, &k2), square = fma(a.square, fma(k, k, s), s);
  real rate = fma(a.square, fma(REAL(2) * k, k1, REAL(1)), REAL(1)), below_zero = fmin(square, REAL(0));
  s -= below_zero / rate;
  square -= below_zero;
  real T = sqrt(square), psi = arc_tangent_2(T, k);
  real least = REAL(4) * fma(T, a.height + REAL(2) * (psi - T), -s);
  real excess = fma(REAL(4), T, fma(REAL(-2), psi, -a.height));
  real slope = fma(REAL(-2), (k - REAL(2) * square * k1 / rate) / fma(k, k, square), REAL(4)), change = excess / slope;
  real next = s + change * fma(REAL(-2), T, change) / rate;
  real most = fma(excess, excess, fma(a.square * below_zero, below_zero, least));
  squeeze found = {least, most, fmin(fmax(next, REAL(COT_START)), REAL(COT_END))};
  return found;
}
#endif

// Steps until other bounds and, at last, the solver are asked: where d < 2 only within 1e-9 of the surface.
#define SQUEEZE_STEPS 2

FN bounds ball_bounds(point q, real radius)
{
  target a = target_at(q);
  bounds b = {REAL(0), REAL(INFINITY)};
  real unknown = first_guess(a);
  mask open = a.square == a.square;
  for (int i = 0; i < SQUEEZE_STEPS && ANY(open); i++) {
    squeeze found = squeeze_at(a, unknown);
    // Lanes that are done stay as they are: what is seen by one may not depend on its neighbours.
    b.below = SELECT(open, fmax(b.below, sqrt(fmax(found.least, REAL(0)))), b.below);
    b.above = SELECT(open, fmin(b.above, sqrt(fmax(found.most, REAL(0)))), b.above);
    open &= too_wide(b, radius);
    unknown = found.next;
  }
  if (ANY(open)) {
    b.below = SELECT(open, fmax(b.below, underestimate(q)), b.below);
    b.above = SELECT(open, fmin(b.above, overestimate(q)), b.above);
  }
  return b;
}

FN real solved_distance(point q, mask *unsolved)
{
  point exact = {REAL(0), REAL(0), REAL(0), REAL(0)};
  return distance_between(origin(), q, exact, exact, unsolved);
}
