// hard_shadow.h - is the light hidden? (paper 5.2). A ray from just above the surface to the light meets an object, or not.

// The start is lifted off the surface by this many hit thresholds, so that the surface does not shade itself.
#define SHADOW_LIFT 4

FN ray lifted_ray(shading s, scene_data scene)
{
  ray r = new_ray(s.p, push(s.p, s.normal));
  flow(&r.p, &r.v, number(scene, HIT_THRESHOLD) * REAL(SHADOW_LIFT));
  return r;
}

// Marches the active lanes of r along u.
FN void cast_shadow(ray r, direction u, real length, arrival *a, int max_steps, scene_data scene, real *shadow_steps)
{
  r.v = push(r.p, u);
  for (int i = 0; i < max_steps && ANY(r.active); i++) r = march_step(r, length, scene);
  *shadow_steps += r.steps;
  a->lit &= NOT(r.hit);
}

// Of a point light, along its k-th geodesic; next to a caustic, where that may have ended just below the start, along that from the surface.
FN void hard_shadow(shading s, arrival *a, point light, int k, int max_steps, scene_data scene, real *shadow_steps)
{
  ray r = lifted_ray(s, scene);
  point exact = {REAL(0), REAL(0), REAL(0), REAL(0)};
  connection c = connect_points(r.p, light, exact, exact, k);
  r.active = a->lit & NOT(c.exists & c.unsolved);
  cast_shadow(r, select_3(c.exists, c.u, a->from), SELECT(c.exists, c.length, a->length), a, max_steps, scene, shadow_steps);
  // As in point.h.
  a->intensity = SELECT(c.exists & c.unsolved, REAL(NAN), a->intensity);
}

// Of the sun, as far as rays go.
FN void sun_shadow(shading s, arrival *a, int max_steps, scene_data scene, real *shadow_steps)
{
  ray r = lifted_ray(s, scene);
  r.active = a->lit;
  cast_shadow(r, a->from, number(scene, FAR), a, max_steps, scene, shadow_steps);
}
