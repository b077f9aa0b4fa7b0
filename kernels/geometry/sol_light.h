// sol_light.h - how far the wave front of a light in Sol has spread: the area density (paper 5.7).
//
// METHOD. One variation of the direction keeps m = ab and gives the field of a Killing field less the velocity; that of another, which
// changes m, follows from the first integrals alone. Their frame degenerates where m = 0 (the hyperbolic planes) and 2m = 1 (a = b,
// c = 0): near there Jacobi's equation is integrated, by Runge and Kutta's rule of order four, from the direction on.
// ACCURACY (maximal error, relative to itself; next to conjugate points, where it vanishes, to min(t, 4)^2/4;
// tests/test_golden_sol.py, test_sol_light.py)
//   directions                                          float     double
//   of the records                                      1.5e-5    6.5e-14
//   any;  1 <= t <= 15                                  2.1e-5    8.2e-14
//   where the closed form begins                        4.1e-5    3.1e-9
//   any;  t < 1                                         4.3e-7    3.2e-10
//   vertical and planes, integrated;  t <= 20           5.0e-5    4.0e-9
//   straight lines, integrated;  t <= 20                3.3e-4    3.2e-8

// The closed form is taken where the lesser of 1 and the time, times m (1 - 4 m^2), exceeds this: it loses EPSILON over that, and next to
// planes over m times that. Integration loses what the length of its steps says.
#ifdef FP64
#define CLOSED_AREA_ABOVE 3e-4
#define AREA_STEP 0.01
#else
#define CLOSED_AREA_ABOVE 5e-2f
#define AREA_STEP 0.1f
#endif

FN real closed_area(direction u, real t, point q, direction end)
{
  real a = u.x, b = u.y, c = u.z, x = q.x, y = q.y, stretch = exp(q.z), shrink = REAL(1) / stretch;
  real m = a * b, square = REAL(4) * m * m, n = REAL(1) - square, across = fma(a, a, b * b), swing = (b - a) * (b + a);
  real covered = fma(a, x, b * y), f = fma(-square, t, covered);
  real turn = (end.x - end.y) * (end.x + end.y), end_across = fma(end.x, end.x, end.y * end.y);
  real d_z = fma(end.z, f, -turn) - swing, d_a = a * (n + swing), d_b = b * (n - swing), d_c = -c * (across + square);
  real moment = fma(b * y, n - swing, fma(-a * x, n + swing, d_c)) + turn * f + end.z * (end_across + square);
  real h_x = shrink * (moment - end.z * d_z) / (REAL(2) * a), h_y = -stretch * (moment + end.z * d_z) / (REAL(2) * b);
  direction h = {h_x, h_y, d_z}, k = {shrink * fma(c, x, a), stretch * fma(-c, y, b), c};
  return dot_3(end, cross_3(h, k)) / (REAL(2) * m * n);
}

// The rates of a field along a geodesic and of the variation of its direction: h' = v + (u_x h_z - u_z h_x, ...), v' from u'.
typedef struct { direction v, h; } field;
typedef struct { direction u; field first, second; } front;

FN field field_rate(direction u, field f)
{
  field r;
  r.v.x = fma(f.v.x, u.z, u.x * f.v.z);
  r.v.y = -fma(f.v.y, u.z, u.y * f.v.z);
  r.v.z = REAL(2) * fma(u.y, f.v.y, -u.x * f.v.x);
  r.h.x = f.v.x + fma(u.x, f.h.z, -u.z * f.h.x);
  r.h.y = f.v.y - fma(u.y, f.h.z, -u.z * f.h.y);
  r.h.z = f.v.z;
  return r;
}

FN field field_moved(field f, field rate, real t)
{
  field r = {add_scaled_3(f.v, rate.v, t), add_scaled_3(f.h, rate.h, t)};
  return r;
}

FN front front_rate(front f)
{
  front r = {acceleration(f.u), field_rate(f.u, f.first), field_rate(f.u, f.second)};
  return r;
}

FN front front_moved(front f, front rate, real t)
{
  front r = {add_scaled_3(f.u, rate.u, t), field_moved(f.first, rate.first, t), field_moved(f.second, rate.second, t)};
  return r;
}

FN real integrated_area(direction u, real t, mask active)
{
  // Two directions across u: the first across the axis that u is farthest from among x and z.
  mask steep = fabs(u.z) > fabs(u.x);
  direction axis = {SELECT(steep, REAL(1), REAL(0)), REAL(0), SELECT(steep, REAL(0), REAL(1))}, nowhere = {REAL(0), REAL(0), REAL(0)};
  direction one = cross_3(u, axis);
  one = scale_3(one, rsqrt(dot_3(one, one)));
  front f = {u, {one, nowhere}, {cross_3(u, one), nowhere}};
  real steps = SELECT(active, floor(t / REAL(AREA_STEP)) + REAL(1), REAL(0)), step = t / fmax(steps, REAL(1));
  mask endless = active & NOT(steps <= REAL(MOST_STEPS));
  steps = SELECT(endless, REAL(0), steps);
  const scalar way[4] = {0, C(0.5), C(0.5), 1}, weight[4] = {C(0.16666666666666667), C(0.33333333333333333), C(0.33333333333333333),
                                                            C(0.16666666666666667)};
  for (int done = 0; done < MOST_STEPS && ANY(REAL(done) < steps); done++) {
    real h = SELECT(REAL(done) < steps, step, REAL(0));
    front sum = f, rate = f;
    for (int k = 0; k < 4; k++) {
      rate = front_rate(k == 0 ? f : front_moved(f, rate, REAL(way[k]) * h));
      sum = front_moved(sum, rate, REAL(weight[k]) * h);
    }
    f = sum;
  }
  return SELECT(endless, REAL(NAN), dot_3(f.u, cross_3(f.first.h, f.second.h)));
}

SOLVER real area_density(direction u, real t, real tail)
{
  // The closed form would make much of a length that is not quite 1.
  u = scale_3(u, rsqrt(dot_3(u, u)));
  direction start = {fabs(u.x), fabs(u.y), u.z}, end = start;
  real time = t + tail, m = start.x * start.y;
  mask closed = fmin(time, REAL(1)) * m * fma(REAL(-4) * m, m, REAL(1)) > REAL(CLOSED_AREA_ABOVE);
  real area = REAL(0);
  if (ANY(closed)) {
    point q = exponential(&end, t, tail);
    area = closed_area(start, time, q, end);
  }
  if (ANY(NOT(closed))) area = SELECT(closed, area, integrated_area(start, time, NOT(closed)));
  return fabs(area);
}
