// hard_shadow.h - is the light hidden? (paper 5.2). A ray from just above the surface to the light meets an object, or not.

// The start is lifted off the surface by this many hit thresholds, so that the surface does not shade itself.
#define SHADOW_LIFT 4

FN void hard_shadow(shading s, arrival *a, point light, int k, int max_steps, scene_data scene, real *shadow_steps)
{
  ray r = new_ray(s.p, push(s.p, s.normal));
  flow(&r.p, &r.v, number(scene, HIT_THRESHOLD) * REAL(SHADOW_LIFT));
  point exact = {REAL(0), REAL(0), REAL(0), REAL(0)};
  connection c = connect_points(r.p, light, exact, exact, k);
  r.active = a->lit & c.exists & NOT(c.unsolved);
  r.v = push(r.p, c.u);
  for (int i = 0; i < max_steps && ANY(r.active); i++) r = march_step(r, c.length, scene);
  *shadow_steps += r.steps;
  a->lit &= NOT(r.hit);
  // As in point.h.
  a->intensity = SELECT(c.exists & c.unsolved, REAL(NAN), a->intensity);
}
