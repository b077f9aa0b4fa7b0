// march/direct.h - sphere tracing (paper 2, 4.1): each step is as long as the distance to the scene is known to be. With masks.

// What goes with a ray beside itself: nothing here. (C has no empty structs.)
typedef int progress;
FN progress begin(ray r, scene_data scene) { return 0; }
FN progress select_progress(mask m, progress a, progress b) { return a; }
// Where the last step asked for the distance, and in which lanes.
FN ray measured(ray before, ray after, progress at) { return before; }
// The ray at its end.
FN ray arrived(ray r, progress at) { return r; }

// One step of every active lane towards `limit`. Lanes outside the cell wait: step 0, then the teleport pass moves them on.
// A NaN fails every comparison, so such a lane stops and is no hit.
FN ray march_step(ray r, progress *at, real limit, int max_steps, scene_data scene)
{
  real distance = scene_distance(r.p, r.v, scene), threshold = hit_threshold(r, scene);
  r.clear = distance;
#ifdef IN_QUOTIENT
  mask inside = NOT(outside_cell(r.p, scene));
#else
  mask inside = r.t == r.t;
#endif
  mask there = r.active & inside & (distance < threshold);
  r.hit |= there;
  r.active &= NOT(there) & (r.t < limit);
#ifdef CREEPING
  // Just over the wall and no further, so that nothing behind it is jumped (paper 4.2.1).
  real wall = wall_time(r.p, r.v, scene) + threshold;
  distance = SELECT(wall < distance, wall, distance);  // unlike fmin it keeps a NaN
#endif
  // No further than the limit: what is behind a light throws no shadow on this side of it.
  real left = limit - r.t;
  distance = SELECT(distance > left, left, distance);
  return count_step(moved_by(r, SELECT(r.active & inside, distance, REAL(0)), scene), max_steps);
}
