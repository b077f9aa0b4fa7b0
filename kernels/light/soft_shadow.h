// soft_shadow.h - how much of the light is hidden? (paper eq. 5.4). The ray to it passes objects; what counts is how near, as seen
// from the surface: K times the least sin of an angle, up to 1.

// The least quotient of the distance that is clear and the length so far, over the ray; 0 where it meets something.
SOLVER void march_softly(ray *from, real limit, int max_steps, scene_data scene, real *least_of_all)
{
  ray r = *from;
  progress at = begin(r, scene);
  real least = REAL(INFINITY);
  while (ANY(r.active)) {
    ray before = r;
    r = march_step(r, &at, limit, max_steps, scene);
    ray asked = measured(before, r, at);
    real clear = scene_clearance(asked.p, r.clear, scene);
    mask nearer = asked.active & (clear < least * asked.t);
    least = SELECT(nearer, clear / asked.t, least);
  }
  *least_of_all = SELECT(r.hit, REAL(0), least);
  *from = arrived(r, at);
}

FN void soft_shadow(shadow_ray q, arrival *a, real sharpness, int max_steps, scene_data scene, work *done)
{
  mask started = q.r.active;
  real least;
  ray r = q.r;
  march_softly(&r, q.length, max_steps, scene, &least);
  done->shadow_steps += r.steps;
  done->distances += distances_of(r, started);
  real left = SELECT(is_lost(r), REAL(NAN), fmin(REAL(1), sharpness * least));
  a->lit &= NOT(left <= REAL(0));
  a->intensity = SELECT(started, a->intensity * left, a->intensity);
}
