// sequence.h - a kernel-reflection sequence, L_0 = K_0, L_{i+1} = K_{i+1} u L_i u R_i L_i: its distance by folding (KRS paper,
// algorithm 1) and its surface.
//
// METHOD. One pass over n levels in place of 2^(n+1) - 1 instances: where x is on the positive side of mirror i it is reflected, and
// the distance to K_i is taken. Every step is 1-Lipschitz, so that the value never exceeds the distance to its own zero set: of the
// instances if each L_i lies on the negative side of its mirror, and else of what is left of them when each mirror clips what reaches
// beyond it (docs/krs.md, "The fold"). ACCURACY against all instances: double 2e-14, float 4e-7 of the size (tests/test_krs_model.py).
//
// Numbers: n; K_n; then for i = n - 1 ... 0 mirror i and K_i.
#define LEVEL_SIZE (MIRROR_SIZE + KERNEL_SIZE)

SOLVER real sequence_distance_at(const point *p, scene_data scene, int k)
{
  point x = *p;
  int levels = (int)scene.numbers[k++];
  real d = kernel_distance(x, scene, k);
  k += KERNEL_SIZE;
  for (int i = 0; i < levels; i++, k += LEVEL_SIZE) {
    x = fold(x, mirror_side(x, scene, k), scene, k);
    d = fmin(d, kernel_distance(x, scene, k + MIRROR_SIZE));
  }
  return distance_at(x, d);
}

FN real sequence_distance(point p, scene_data scene, int k) { return sequence_distance_at(&p, scene, k); }

SOLVER void sequence_surface_at(const point *p, surface *s, scene_data scene, int k)
{
  point x = *p;
  real shares[MOST_LEVELS];
  int levels = (int)scene.numbers[k], top = k + 1, first = top + KERNEL_SIZE;
  nearest_kernel best = {REAL(INFINITY), REAL(0), x};
  compare_kernel(&best, x, 0, scene, top);
  for (int i = 0, m = first; i < levels; i++, m += LEVEL_SIZE) {
    real side = mirror_side(x, scene, m);
    shares[i] = reflected_share(side, scene.numbers[m + MIRROR_WIDTH]);
    x = fold(x, side, scene, m);
    compare_kernel(&best, x, i + 1, scene, m + MIRROR_SIZE);
  }

  // The kernel that is nearest, as it sees the point.
  surface found = {REAL(INFINITY), {REAL(0), REAL(0), REAL(0), REAL(1)}, REAL(0), REAL(0)};
  take_surface(&found, best, 0, scene, top);
  for (int i = 0; i < levels; i++) take_surface(&found, best, i + 1, scene, first + i * LEVEL_SIZE + MIRROR_SIZE);

  // Back through the mirrors that lie before it.
  for (int i = levels - 1; i >= 0; i--) {
    mask before = best.level > REAL(i);
    found.gradient = fold_back(found.gradient, SELECT(before, shares[i], REAL(0)), scene, first + i * LEVEL_SIZE);
  }
  *s = found;
}

FN surface sequence_surface(point p, scene_data scene, int k)
{
  surface s;
  sequence_surface_at(&p, &s, scene, k);
  return s;
}
