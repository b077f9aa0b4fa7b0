// kernels.h - which kernel of a sequence stands at a level: only kinds that are pasted before, so that a model has the code of what it
// is made of. There are up to MOST_LEVELS levels. A record: its kind, 0 for none; the part of the object it belongs to; what the kind has, 18 numbers at most.
#define MOST_LEVELS 40
#define KERNEL_PART 1
#define KERNEL_HEAD 2
#define KERNEL_SIZE 20

FN real kernel_distance(point x, scene_data scene, int k)
{
  int from = k + KERNEL_HEAD;
  switch ((int)scene.numbers[k]) {
#ifdef KRS_SPHERE
    case KRS_SPHERE: return krs_sphere_distance(x, scene, from);
#endif
#ifdef KRS_PLANE
    case KRS_PLANE: return krs_plane_distance(x, scene, from);
#endif
#ifdef KRS_CAPSULE
    case KRS_CAPSULE: return krs_capsule_distance(x, scene, from);
#endif
#ifdef KRS_TOROIDAL_CAPSULE
    case KRS_TOROIDAL_CAPSULE: return krs_toroidal_capsule_distance(x, scene, from);
#endif
#ifdef KRS_LENS_LEAF
    case KRS_LENS_LEAF: return krs_lens_leaf_distance(x, scene, from);
#endif
    default: return REAL(INFINITY);
  }
}

FN surface kernel_surface(point x, scene_data scene, int k)
{
  int from = k + KERNEL_HEAD;
  surface none = {REAL(INFINITY), {REAL(0), REAL(0), REAL(0), REAL(0)}, REAL(0), REAL(0)}, s = none;
  switch ((int)scene.numbers[k]) {
#ifdef KRS_SPHERE
    case KRS_SPHERE: s = krs_sphere_surface(x, scene, from); break;
#endif
#ifdef KRS_PLANE
    case KRS_PLANE: s = krs_plane_surface(x, scene, from); break;
#endif
#ifdef KRS_CAPSULE
    case KRS_CAPSULE: s = krs_capsule_surface(x, scene, from); break;
#endif
#ifdef KRS_TOROIDAL_CAPSULE
    case KRS_TOROIDAL_CAPSULE: s = krs_toroidal_capsule_surface(x, scene, from); break;
#endif
#ifdef KRS_LENS_LEAF
    case KRS_LENS_LEAF: s = krs_lens_leaf_surface(x, scene, from); break;
#endif
    default: break;
  }
  s.part = number(scene, k + KERNEL_PART);
  return s;
}

// The kernel that is nearest so far: its distance, its level and the point as it sees it.
typedef struct { real distance, level; point seen; } nearest_kernel;

FN void compare_kernel(nearest_kernel *best, point x, int level, scene_data scene, int k)
{
  real d = kernel_distance(x, scene, k);
  mask nearer = d < best->distance;
  best->distance = SELECT(nearer, d, best->distance);
  best->level = SELECT(nearer, REAL(level), best->level);
  best->seen = select_4(nearer, x, best->seen);
}

// The surface of the nearest kernel where it is that of this level.
FN void take_surface(surface *s, nearest_kernel best, int level, scene_data scene, int k)
{
  mask here = best.level == REAL(level);
  if (ANY(here)) *s = nearer_of(kernel_surface(best.seen, scene, k), *s, here);
}

// How much of a reflection a gradient takes where the point was `side` beyond the mirror: all or nothing, or within a width about the
// mirror a share in between, one half on the mirror itself, where it removes what the two sides disagree about (KRS paper 8.1).
FN real reflected_share(real side, scalar width)
{
  if (!(width > 0)) return SELECT(side > REAL(0), REAL(1), REAL(0));
  real t = fmin(fmax(fma(side, REAL(C(0.5) / width), REAL(C(0.5))), REAL(0)), REAL(1));
  return t * t * fma(REAL(-2), t, REAL(3));
}

// A distance that remembers that there was no point: comparisons forget it.
FN real distance_at(point p, real d)
{
  real sum = p.x + p.y + p.z + p.w;
  return SELECT(sum == sum, d, sum);
}
