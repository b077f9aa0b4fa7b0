// ball.h - the ball about the origin of the object's own coordinates (paper, tables 2-4, 8.2, 9.6, 10.6).
// Coordinates on it: longitude in turns, latitude in half turns, both from 0 to 1, of the direction at the centre of the
// shortest geodesic from there.
FN surface surface_of_ball(real distance, covector gradient, real across, direction at_centre)
{
  surface s = {distance, gradient,
               fma(arc_tangent_2(at_centre.y, at_centre.x), REAL(C(0.15915494309189535)), REAL(C(0.5))),
               fma(arc_tangent_2(at_centre.z, across), REAL(C(0.31830988618379067)), REAL(C(0.5)))};
  return s;
}

FN real across_of(direction u) { return sqrt(fma(u.x, u.x, u.y * u.y)); }

#ifdef COSTLY_DISTANCE
// In nil and sl2 the distance d from o lies between two bounds that cost much less than itself (in place of paper 9.6, 10.6).
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

// Bounds are near enough when the nearer one is half of the way to the surface, or when they differ by rounding alone.
#define SQUEEZE_ROUNDING 16
// Steps until other bounds and, at last, the solver are asked: where d < 2 only within 1e-9 of the surface.
#define SQUEEZE_STEPS 2

FN mask too_wide(real below, real above, real radius)
{
  real way = fmax(below - radius, radius - above);
  return above - below > fmax(way, REAL(SQUEEZE_ROUNDING * EPSILON) * above);
}

FN real ball_distance(point q, real radius)
{
  target a = target_at(q);
  real below = REAL(0), above = REAL(INFINITY), unknown = first_guess(a);
  mask open = a.square == a.square;
  for (int i = 0; i < SQUEEZE_STEPS && ANY(open); i++) {
    squeeze found = squeeze_at(a, unknown);
    // Lanes that are done stay as they are: what is seen by one may not depend on its neighbours.
    below = SELECT(open, fmax(below, sqrt(fmax(found.least, REAL(0)))), below);
    above = SELECT(open, fmin(above, sqrt(fmax(found.most, REAL(0)))), above);
    open &= too_wide(below, above, radius);
    unknown = found.next;
  }
  if (ANY(open)) {
    below = SELECT(open, fmax(below, underestimate(q)), below);
    above = SELECT(open, fmin(above, overestimate(q)), above);
    open &= too_wide(below, above, radius);
  }
  if (ANY(open)) {
    point exact = {REAL(0), REAL(0), REAL(0), REAL(0)};
    mask unsolved;
    real solved = distance_between(origin(), select_4(open, q, origin()), exact, exact, &unsolved);
    open &= NOT(unsolved);
    below = SELECT(open, solved, below);
    above = SELECT(open, solved, above);
  }
  real distance = SELECT(above < radius, above, below) - radius, size = a.square + a.height;
  // fmin and fmax forget a NaN.
  return SELECT(size == size, distance, size);
}

// Where the geodesic from the centre is looked for: farther than anything that counts as a hit.
#define BALL_SEEN_BELOW C(0.1)

FN surface ball_surface(point q, real radius)
{
  point exact = {REAL(0), REAL(0), REAL(0), REAL(0)};
  real distance = ball_distance(q, radius);
  mask seen = fabs(distance) < REAL(BALL_SEEN_BELOW);
  direction u = {REAL(0), REAL(0), REAL(1)}, arriving = u;
  if (ANY(seen)) {
    connection c = connect_points(origin(), select_4(seen, q, origin()), exact, exact, 0);
    u = arriving = c.u;
    exponential(&arriving, c.length, REAL(0));
    // Where the solver reached its bound there is no normal, and the pixel is counted.
    arriving.x = SELECT(seen & c.unsolved, REAL(NAN), arriving.x);
  }
  // Spheres cross the geodesics from their centre at right angles (Gauss' lemma).
  return surface_of_ball(distance, with_w(arriving, REAL(0)), across_of(u), u);
}

#elif HOMOGENEOUS == 5
// The distance from o in the factor, and that over its sine, 1 at o. Where S2 is farthest away the quotient stays finite, and
// large enough for the frame there (s2xe.h).
FN real arc_over_sine(point q, real *arc)
{
  real sine = sqrt(fma(q.x, q.x, q.y * q.y));
#if CURVATURE == 1
  sine = fmax(sine, REAL(ANTIPODE_OFFSET));
  *arc = arc_tangent_2(sine, q.z);
#else
  sine = fmax(sine, REAL(TINY));
  *arc = arc_of_sine(sine);
#endif
  return *arc / sine;
}

FN real ball_distance(point q, real radius) { return origin_distance(q) - radius; }

FN surface ball_surface(point q, real radius)
{
  // Half the gradient of the squared distance.
  real arc, ratio = arc_over_sine(q, &arc);
  covector gradient = {REAL(0), REAL(0), REAL(-CURVATURE) * ratio, q.w};
  direction at_centre = {q.x, q.y, q.w};
  return surface_of_ball(ball_distance(q, radius), gradient, arc, at_centre);
}

#else
FN real ball_distance(point q, real radius) { return origin_distance(q) - radius; }

FN surface ball_surface(point q, real radius)
{
#if CURVATURE == 0
  covector gradient = {q.x, q.y, q.z, REAL(0)};
#else
  // Of -<o, q>, which grows with the distance all the way; |x| falls again past the equator of s3.
  covector gradient = {REAL(0), REAL(0), REAL(0), REAL(-CURVATURE)};
#endif
  return surface_of_ball(ball_distance(q, radius), gradient, across_of(first_3(q)), first_3(q));
}
#endif
