// march/binary.h - binary sphere tracing (kernel-reflection sequences, section 9, algorithm 2, with its steps in order): whether a ball is
// free of the scene is all that is asked. The ball touches the ray's end from ahead; where it is free the ray goes through it and the
// next one is larger, else it is tried smaller. In e3, whole space. Shadows are hard: no distance is known.
FN mask scene_unbounding(point c, real radius, scene_data scene);

// How much larger the next ball is, and how much smaller: at the same depth error the fewest probes among five pairs from (1.3, 0.5) to
// (3, 0.3), by 3 %.
#define BINARY_BONUS 2
#define BINARY_PENALTY C(0.3)
// The ray has hit when its ball is smaller than this share of the threshold: then the depths are as exact as by direct tracing, which
// measured 0.25 to 0.4.
#define BINARY_ACCURACY C(0.3)
// The first ball as a share of how far rays go; a wrong guess costs a probe for each doubling.
#define BINARY_FIRST C(0.01)

typedef struct { real radius; } progress;
FN progress begin(ray r, scene_data scene)
{
  progress at = {number(scene, FAR) * REAL(BINARY_FIRST)};
  return at;
}
FN progress select_progress(mask m, progress a, progress b)
{
  progress at = {SELECT(m, a.radius, b.radius)};
  return at;
}
FN ray measured(ray before, ray after, progress at) { return before; }
FN ray arrived(ray r, progress at) { return r; }

FN ray march_step(ray r, progress *at, real limit, int max_steps, scene_data scene)
{
  // No ball reaches beyond the limit, along the ray: what is more than a threshold behind a light throws no shadow on this side of it.
  real radius = fmin(at->radius, REAL(C(0.5)) * (limit - r.t));
  point c = add_scaled_4(r.p, r.v, radius);
  mask clear = scene_unbounding(c, radius, scene);
  // A ray that is none is lost; its ball shrinks as if it met something.
  mask lost = NOT(dot_4(c, c) < REAL(INFINITY));
  mask there = r.active & NOT(clear) & NOT(lost)
               & (REAL(BINARY_PENALTY) * radius <= REAL(BINARY_ACCURACY) * hit_threshold(r, scene));
  r.hit |= there;
  r.active &= NOT(there) & NOT(lost) & (r.t < limit);
  r.t = SELECT(lost, REAL(NAN), r.t);
  at->radius = radius * SELECT(clear, REAL(BINARY_BONUS), REAL(BINARY_PENALTY));
  return count_step(moved_by(r, SELECT(r.active & clear, REAL(2) * radius, REAL(0)), scene), max_steps);
}
