// reflection.h - mirrors (paper 5.4): from a surface that reflects, the mirrored ray is marched on, up to `depth` times. What it shows
// takes the share of the surface's reflectivity; fog lies on the whole way.
FN real3_lanes seen_with_reflections(ray r, look *first, int depth, int max_steps, scene_data scene, work *done)
{
  real3_lanes seen = {REAL(0), REAL(0), REAL(0)};
  real share = REAL(1), from = REAL(0);
  for (int bounce = 0;; bounce++) {
    look l = look_at(r, from + r.t, max_steps, scene, done);
    if (bounce == 0) *first = l;
    real mirrored = bounce < depth ? SELECT(r.hit, l.s.m.reflectivity, REAL(0)) : REAL(0);
#ifdef SKY
    // Lanes that are done hold any ray, of which 0 times the sky may be none.
    l.color = select_3(share > REAL(0), scene_under_sky(r, l.color, scene), l.color);
    // What is behind everything is behind no fog.
    real to = SELECT(r.hit, from + r.t, from);
#else
    real to = SELECT(r.hit, from + r.t, REAL(INFINITY));
#endif
    real left = scene_clear(to, scene) / fmax(scene_clear(from, scene), REAL(TINY));
    seen = add_scaled_3(seen, scene_air(scale_3(l.color, REAL(1) - mirrored), left, scene), share);
    share *= left * mirrored;
    from = to;
    mask open = share > REAL(0);
    if (!ANY(open)) return seen;
    direction u = scale_3(l.s.viewer, REAL(-1));
    ray next = lifted_ray(l.s, scene);
    next.v = push(next.p, add_scaled_3(u, l.s.normal, REAL(-2) * dot_3(u, l.s.normal)));
    next.active = open;
    r = next;
    march(&r, number(scene, FAR), max_steps, scene);
    share = SELECT(open & is_lost(r), REAL(NAN), share);
    done->reflection_steps += r.steps;
    done->distances += distances_of(r, open);
    // One out of steps shows what it came nearest to, as a first ray does.
    r.hit |= r.spent;
  }
}
