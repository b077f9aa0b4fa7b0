// march.h - a ray that is marched (paper 2, 4.1), and what the scene and the ways to march it say to each other. How far a ray may go at
// once is what march/direct.h, relaxed.h, compound.h and binary.h answer, one of them in each program; march/loop.h marches to the end.
//
// The scene part gives scene_distance; outside_cell, teleport and, where the scene creeps, wall_time.
typedef struct {
  point p;
  vector v;
  real t, steps, cell;
  real before;  // the length of the way from the eye to where the ray begins: of shadow and mirrored rays
  real clear;   // the bound of the distance to the scene where the last step began
  mask active, hit;
  mask spent;   // ended because it is out of steps
} ray;

// How far beyond a wall a point counts as outside, in units of rounding: without it a point on a wall is sent to and fro.
#define WALL_SLACK 64
FN real wall_slack(point p) { return REAL(WALL_SLACK * EPSILON) * coordinate_size(p); }

FN ray new_ray(point p, vector v)
{
  ray r = {p, v, REAL(0), REAL(0), REAL(0), REAL(0), REAL(0)};
  r.active = r.t == r.t;
  r.hit = r.spent = NOT(r.active);
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

// How near counts as a hit, at this length of the way from the eye.
#ifdef DETAIL
// Level of detail (kernel-reflection sequences, section 4): nothing finer than so many pixels, number DETAIL of the buffer. The
// angle between pixels times the way is what a pixel covers in Euclidean space.
FN real threshold_at(real way, scene_data scene)
{
  return fmax(number(scene, HIT_THRESHOLD), number(scene, DETAIL) * number(scene, PIXEL_ANGLE) * way);
}
#else
FN real threshold_at(real way, scene_data scene) { return number(scene, HIT_THRESHOLD); }
#endif
FN real hit_threshold(ray r, scene_data scene) { return threshold_at(r.before + r.t, scene); }

// Moves the active lanes on by t, back where it is negative, with one branch-free teleport pass. Lanes that have ended stand still to
// the last bit, however long they wait for the others.
FN ray moved_by(ray r, real t, scene_data scene)
{
  ray moved = r;
  ray_flow(&moved.p, &moved.v, t);
#ifdef IN_QUOTIENT
  teleport(&moved, scene);
#endif
  reproject(&moved.p, &moved.v);
  r.p = select_4(r.active, moved.p, r.p);
  r.v = select_4(r.active, moved.v, r.v);
  r.cell = SELECT(r.active, moved.cell, r.cell);
  r.t += t;
  return r;
}

// Counts a step of the active lanes, and ends those that have made all they may.
FN ray count_step(ray r, int max_steps)
{
  r.steps += SELECT(r.active, REAL(1), REAL(0));
  r.spent |= r.active & NOT(r.steps < REAL(max_steps));
  r.active &= NOT(r.spent);
  return r;
}
