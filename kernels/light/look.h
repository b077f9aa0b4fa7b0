// look.h - what a ray that has ended shows: the surface there in the light of the scene, or the background.
typedef struct {
  real3_lanes color;
  real cell;
  shading s;
} look;

// Of a ray whose way from the eye has this length.
FN look look_at(ray r, real length, int max_steps, scene_data scene, work *done)
{
  look l;
  direction none = {REAL(0), REAL(0), REAL(0)};
  l.s.object = REAL(0);
  l.cell = r.cell;
  l.color = scene_background(scene);
  l.s.normal = none;
  if (!ANY(r.hit)) return l;
  covector gradient;
  scene_surface(r.p, r.v, length, &l.s.object, &l.cell, &gradient, &l.s.m, scene);
  direction g = pull_covector(r.p, gradient), u = pull(r.p, r.v);
  l.s.p = r.p;
  l.s.cell = r.cell;
  l.s.way = length;
  l.s.normal = scale_3(g, rsqrt(dot_3(g, g)));
  l.s.viewer = scale_3(u, -rsqrt(dot_3(u, u)));
  real3_lanes lit;
  scene_light(&l.s, r.hit, max_steps, scene, done, &lit);
  l.color = select_3(r.hit, lit, l.color);
  return l;
}
