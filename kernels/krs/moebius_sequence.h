// moebius_sequence.h - a Moebius kernel-reflection sequence, L_{i+1} = G_i(K_{i+1} u L_i u R L_i) with R: x -> -x (KRS paper 7): a bound
// of its distance, whether a ball is free of it (algorithm 3, corrected), its surface.
//
// METHOD. The image of a ball under a Moebius map is a ball, but not about the image of its centre, which is why the paper tries balls.
// The largest ball about the image that fits has radius 1/rho' = (1/lambda)(1/rho + 1/D), lambda the factor and D the distance of the
// pole: affine in 1/rho, so that walking inwards two numbers A and B tell for a kernel at distance d the radius 1/(A/d + B) of a free
// ball about the point in the world (docs/krs.md, "Moebius maps"). Never above the distance; near a surface it is the distance itself
// (0.98 of it at 0.1 of a radius above, 0.9998 at 0.001). But it is no more than half the distance from the pole of a map, where there is nothing: there a
// ball that holds L_i tells that all of it is far.
//
// Numbers: n; the ball that holds all (centre, radius; or radius < 0); then for i = n - 1 ... 0 the inverse of G_i, a width, the ball that holds L_i (centre, radius; or radius < 0), K_{i+1};
// then K_0.
#define MOEBIUS_HEAD 5
#define BALL_PLACE (MOEBIUS_SIZE + 1)
#define MOEBIUS_KERNEL (BALL_PLACE + 4)
#define MOEBIUS_LEVEL (MOEBIUS_KERNEL + KERNEL_SIZE)

// The radius in the world of the ball that something at distance d leaves free, or inside it fills: d over this.
FN real radius_divisor(real d, real a, real b) { return fma(b, fabs(d), a); }

// The least radius so far, as a fraction: comparing takes products, where a quotient at each level would cost as much as a kernel.
typedef struct { real numerator, divisor; } least_radius;

FN void leave_room_for(least_radius *least, point x, real a, real b, scene_data scene, int k)
{
  if (!(scene.numbers[k] > 0)) return;
  real d = kernel_distance(x, scene, k), divisor = radius_divisor(d, a, b);
  mask less = d * least->divisor < least->numerator * divisor;
  least->numerator = SELECT(less, d, least->numerator);
  least->divisor = SELECT(less, divisor, least->divisor);
}

// How far the point is outside a ball of the buffer; where there is none, nothing is known to be outside.
FN real distance_from_ball(point x, scene_data scene, int k)
{
  if (!(scene.numbers[k + 3] >= 0)) return REAL(-INFINITY);
  direction from = add_scaled_3(first_3(x), three_numbers(scene, k), REAL(-1));
  return sqrt(dot_3(from, from)) - number(scene, k + 3);
}

// How much room that leaves for the point in the world.
FN real outside_ball(point x, real a, real b, scene_data scene, int k)
{
  real d = distance_from_ball(x, scene, k);
  return SELECT(d > REAL(0), d / radius_divisor(d, a, b), REAL(-INFINITY));
}

FN point mirrored(point x)
{
  x.x = -fabs(x.x);
  return x;
}

SOLVER real moebius_sequence_distance_at(const point *p, scene_data scene, int k)
{
  point x = *p;
  // Up to the next ball, which says how far all that follows is at least.
  least_radius none = {REAL(INFINITY), REAL(1)}, least = none;
  real a = REAL(1), b = REAL(0), bound = REAL(INFINITY), outside = outside_ball(x, a, b, scene, k + 1);
  int levels = (int)scene.numbers[k];
  k += MOEBIUS_HEAD;
  for (int i = 0; i < levels; i++, k += MOEBIUS_LEVEL) {
    pole_view v = seen_from_pole(x, scene, k);
    // At the pole itself what follows is as good as no room, and only balls tell more.
    real share = REAL(1) / fmax(v.distance_square, REAL(TINY));
    if (scene.numbers[k] > 0) b = fma(a, sqrt(share), b);
    a *= number(scene, k + 16) * share;
    x = turned_and_moved(v.from_pole, share, scene, k);
    leave_room_for(&least, x, a, b, scene, k + MOEBIUS_KERNEL);
    x = mirrored(x);
    if (scene.numbers[k + BALL_PLACE + 3] >= 0) {
      bound = fmin(bound, fmax(least.numerator / least.divisor, outside));
      least = none;
      outside = fmax(outside, outside_ball(x, a, b, scene, k + BALL_PLACE));
      // What follows leaves more room than there is left.
      if (!ANY(outside < bound)) return distance_at(x, bound);
    }
  }
  leave_room_for(&least, x, a, b, scene, k);
  return distance_at(x, fmin(bound, fmax(least.numerator / least.divisor, outside)));
}

FN real moebius_sequence_distance(point p, scene_data scene, int k) { return moebius_sequence_distance_at(&p, scene, k); }

// Whether the ball is free of the model. It may say no to a free ball that one of the maps turns inside out, unless a ball that holds
// all that follows is apart from it: else rays would meet the pole of a map in empty space.
SOLVER mask moebius_sequence_unbounding_at(const point *c, const real *radius, scene_data scene, int k)
{
  point x = *c;
  real r = *radius;
  mask ok = r >= REAL(0), apart = ok & (distance_from_ball(x, scene, k + 1) >= r);
  int levels = (int)scene.numbers[k];
  k += MOEBIUS_HEAD;
  for (int i = 0; i < levels && ANY(ok & NOT(apart)); i++, k += MOEBIUS_LEVEL) {
    moebius_ball(&x, &r, &ok, scene, k);
    ok &= kernel_distance(x, scene, k + MOEBIUS_KERNEL) >= r;
    x = mirrored(x);
    apart |= ok & (distance_from_ball(x, scene, k + BALL_PLACE) >= r);
  }
  if (ANY(ok & NOT(apart))) ok &= kernel_distance(x, scene, k) >= r;
  return ok | apart;
}

FN mask moebius_sequence_unbounding(point c, real radius, scene_data scene, int k)
{
  return moebius_sequence_unbounding_at(&c, &radius, scene, k);
}

SOLVER void moebius_sequence_surface_at(const point *p, surface *s, scene_data scene, int k)
{
  point x = *p, before[MOST_LEVELS];
  real shares[MOST_LEVELS], a = REAL(1), factor;
  int levels = (int)scene.numbers[k], first = k + MOEBIUS_HEAD, innermost = first + levels * MOEBIUS_LEVEL;
  // Which kernel is nearest in the world: near a surface to first order, distance over factor.
  real least = REAL(INFINITY);
  nearest_kernel best = {REAL(INFINITY), REAL(0), x};
  for (int i = 0; i <= levels; i++) {
    int m = first + i * MOEBIUS_LEVEL, own = i < levels ? m + MOEBIUS_KERNEL : innermost;
    if (i < levels) {
      before[i] = x;
      x = moebius_image(x, &factor, scene, m);
      a *= factor;
    }
    real d = kernel_distance(x, scene, own) / a;
    mask nearer = d < best.distance;
    best.distance = SELECT(nearer, d, best.distance);
    best.level = SELECT(nearer, REAL(i), best.level);
    best.seen = select_4(nearer, x, best.seen);
    if (i < levels) {
      shares[i] = reflected_share(x.x, scene.numbers[m + MOEBIUS_SIZE]);
      x = mirrored(x);
    }
  }

  surface found = {REAL(INFINITY), {REAL(0), REAL(0), REAL(0), REAL(1)}, REAL(0), REAL(0)};
  for (int i = 0; i <= levels; i++)
    take_surface(&found, best, i, scene, i < levels ? first + i * MOEBIUS_LEVEL + MOEBIUS_KERNEL : innermost);
  found.distance = best.distance;

  // Back through the maps and mirrors that lie before it.
  for (int i = levels - 1; i >= 0; i--) {
    covector g = found.gradient;
    g.x *= SELECT(best.level > REAL(i), fma(REAL(-2), shares[i], REAL(1)), REAL(1));
    covector pulled = moebius_pull_back(g, before[i], scene, first + i * MOEBIUS_LEVEL);
    mask through = best.level >= REAL(i);
    found.gradient = select_4(through, pulled, g);
  }
  *s = found;
}

FN surface moebius_sequence_surface(point p, scene_data scene, int k)
{
  surface s;
  moebius_sequence_surface_at(&p, &s, scene, k);
  return s;
}
