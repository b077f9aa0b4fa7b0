// march.h - the ray marcher (paper 2, 4.1): sphere tracing with masks, one branch-free teleport pass a step.
//
// The scene part gives scene_distance; outside_cell, teleport and, where the scene creeps, wall_time.
typedef struct {
  point p;
  vector v;
  real t, steps, cell;
  real clear;  // the bound of the distance to the scene where the last step began
  mask active, hit;
} ray;

// How far beyond a wall a point counts as outside, in units of rounding: without it a point on a wall is sent to and fro.
#define WALL_SLACK 64
FN real wall_slack(point p) { return REAL(WALL_SLACK * EPSILON) * coordinate_size(p); }

FN ray new_ray(point p, vector v)
{
  ray r = {p, v, REAL(0), REAL(0), REAL(0), REAL(0)};
  r.active = r.t == r.t;
  r.hit = NOT(r.active);
  return r;
}

#ifdef IN_QUOTIENT
FN mask outside_cell(point p, scene_data scene);
FN void teleport(ray *r, scene_data scene);
FN real wall_time(point p, vector v, scene_data scene);
#endif
// A bound of the distance to the scene; directed shapes (paper 12.3) bound it along v alone.
FN real scene_distance(point p, vector v, scene_data scene);
#ifdef CLEARANCE
// The distance itself in all directions, as near as it is known, for what shades by it; `clear` is what scene_distance says.
FN real scene_clearance(point p, real clear, scene_data scene);
#else
FN real scene_clearance(point p, real clear, scene_data scene) { return clear; }
#endif

// One step of every active lane towards `limit`. Lanes outside the cell wait: step 0, then the teleport pass moves them on.
// A NaN fails every comparison, so such a lane stops and is no hit.
FN ray march_step(ray r, real limit, scene_data scene)
{
  real distance = scene_distance(r.p, r.v, scene), threshold = number(scene, HIT_THRESHOLD);
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
  real t = SELECT(r.active & inside, distance, REAL(0));
  ray moved = r;
  flow(&moved.p, &moved.v, t);
#ifdef IN_QUOTIENT
  teleport(&moved, scene);
#endif
  reproject(&moved.p, &moved.v);
  // Lanes that have ended stand still to the last bit, however long they wait for the others.
  r.p = select_4(r.active, moved.p, r.p);
  r.v = select_4(r.active, moved.v, r.v);
  r.cell = SELECT(r.active, moved.cell, r.cell);
  r.t += t;
  r.steps += SELECT(r.active, REAL(1), REAL(0));
  return r;
}

// Marches the active lanes until the last has ended; those still active then are out of steps. Not inlined: rays of all kinds
// share it. The loop works on a copy, which stays in registers.
SOLVER void march(ray *from, real limit, int max_steps, scene_data scene)
{
  ray r = *from;
  for (int i = 0; i < max_steps && ANY(r.active); i++) r = march_step(r, limit, scene);
  *from = r;
}
