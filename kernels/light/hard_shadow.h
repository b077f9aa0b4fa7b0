// hard_shadow.h - is the light hidden? (paper 5.2). The ray to it meets an object, or not.
FN void hard_shadow(shadow_ray q, arrival *a, int max_steps, scene_data scene, work *done)
{
  mask started = q.r.active;
  ray r = q.r;
  march(&r, q.length, max_steps, scene);
  done->shadow_steps += r.steps;
  done->distances += distances_of(r, started);
  a->lit &= NOT(r.hit);
  a->intensity = SELECT(started & is_lost(r), REAL(NAN), a->intensity);
}
