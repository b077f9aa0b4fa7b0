// lifted_ray.h - a ray that leaves a surface: towards a light, or mirrored.

// The start is lifted off the surface by this many of the hit thresholds that hold there, so that the surface does not end the ray itself.
#define SURFACE_LIFT 4

// Not inlined: each kind of light and mirror begins with it, and a flow is long.
SOLVER void lift_off(const shading *s, real height, ray *lifted)
{
  ray r = new_ray(s->p, push(s->p, s->normal));
  flow(&r.p, &r.v, height);
  r.cell = s->cell;
  r.before = s->way;
  *lifted = r;
}

FN ray lifted_ray(shading s, scene_data scene)
{
  ray r;
  lift_off(&s, threshold_at(s.way, scene) * REAL(SURFACE_LIFT), &r);
  return r;
}

// Whether a ray that was marched met a number that is none: its pixel has to be counted, not shown.
FN mask is_lost(ray r) { return NOT(r.t == r.t); }

// How often a ray that was marched asked for the distance: once a step, and where it ended.
FN real distances_of(ray r, mask started) { return r.steps + SELECT(started & NOT(r.spent), REAL(1), REAL(0)); }
