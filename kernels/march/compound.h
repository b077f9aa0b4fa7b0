// march/compound.h - every object of the scene is marched by itself (kernel-reflection sequences, sections 5.1 and 10): each component has a
// length of its own up to which the ray is free of it, and the nearest is asked for next. A ray that passes close by one object takes
// short steps for that one alone, and none for one whose ball it does not enter (march/stretch.h). In the whole space, where any length is flowed along at once: isotropic geometries and products.
//
// The lanes of a packet differ in which component is nearest: the one that is so in most lanes is asked for in all that can use it, those
// not ended in which it lies before what they have already met. (To ask for the one that is least far in any lane takes more steps of
// the packet.) What a lane ends at does not depend on the others; the count of its steps does.
FN real scene_component(int k, point p, vector v, scene_data scene);
// Along which stretch of the ray, from where it begins, the k-th can be met.
FN stretch scene_stretch(int k, ray r, scene_data scene);

typedef struct {
  point p;
  vector v;
  real from;                // where the ray began, and the length of its way then
  real t[COMPONENTS];       // how far it is free of each component, from there; +infinity where that is met or left out
  real leave[COMPONENTS];   // beyond which none of it is met
  real steps[COMPONENTS];
  real end;                 // the least length at which a component is met or out of steps, from there
  mask met, asked;          // whether it is met at the end; lanes in which the last step asked
} progress;

// The least length that is free of a component: all that the ray is known to be free of.
FN real nearest_of(const progress *at)
{
  real t = at->t[0];
  for (int k = 1; k < COMPONENTS; k++) t = fmin(t, at->t[k]);
  return t;
}

// `near`: whether it counts too how near the ray passes what it does not meet.
FN progress begin_near(ray r, int near, scene_data scene)
{
  progress at = {r.p, r.v, r.t};
  for (int k = 0; k < COMPONENTS; k++) {
    stretch s = near ? everywhere() : scene_stretch(k, r, scene);
    at.t[k] = scene.skipped == k + 1 ? REAL(INFINITY) : s.enter;
    at.leave[k] = s.leave;
    at.steps[k] = REAL(0);
  }
  at.end = REAL(INFINITY);
  at.met = at.asked = NOT(r.active | NOT(r.active));
  return at;
}

FN progress begin(ray r, scene_data scene) { return begin_near(r, 0, scene); }
FN progress begin_softly(ray r, scene_data scene) { return begin_near(r, 1, scene); }

FN progress select_progress(mask m, progress a, progress b)
{
  progress at = b;
  at.p = select_4(m, a.p, b.p);
  at.v = select_4(m, a.v, b.v);
  at.from = SELECT(m, a.from, b.from);
  for (int k = 0; k < COMPONENTS; k++) {
    at.t[k] = SELECT(m, a.t[k], b.t[k]);
    at.leave[k] = SELECT(m, a.leave[k], b.leave[k]);
    at.steps[k] = SELECT(m, a.steps[k], b.steps[k]);
  }
  at.end = SELECT(m, a.end, b.end);
  at.met = (m & a.met) | (NOT(m) & b.met);
  return at;
}

// Where the last step asked for the distance, and in which lanes.
FN ray measured(ray before, ray after, progress at)
{
  after.active = at.asked;
  return after;
}

// The ray at its end: where it meets a component, is out of steps, or as far as it may go.
FN ray arrived(ray r, progress at)
{
  // A NaN is kept.
  real nearest = nearest_of(&at), t = SELECT(nearest < at.end, nearest, at.end);
  r.p = at.p;
  r.v = at.v;
  ray_flow(&r.p, &r.v, t);
  reproject(&r.p, &r.v);
  r.t = at.from + t;
  return r;
}

// Asks for one component, and moves the lanes on that can use it.
FN ray march_step(ray r, progress *at, real limit, int max_steps, scene_data scene)
{
  // Choose the component that is the nearest in most lanes.
  real nearest = SELECT(r.active, nearest_of(at), REAL(-1));
  int k = 0, most_lanes = 0;
  for (int other = 0; other < COMPONENTS; other++) {
    int lanes = COUNT(at->t[other] <= nearest);
    if (lanes > most_lanes) {
      most_lanes = lanes;
      k = other;
    }
  }

  // Ask for it.
  real most = limit - at->from, before = SELECT(at->end < most, at->end, most);
  at->asked = r.active & (at->t[k] < before);
  real t = SELECT(at->asked, at->t[k], REAL(0));
  ray there = new_ray(at->p, at->v);
  ray_flow(&there.p, &there.v, t);
  reproject(&there.p, &there.v);
  real distance = scene_component(k, there.p, there.v, scene);
  r.clear = distance;
  r.p = select_4(at->asked, there.p, r.p);
  r.v = select_4(at->asked, there.v, r.v);
  r.t = SELECT(at->asked, at->from + t, r.t);

  // Met, out of steps, or free for a while.
  mask met = at->asked & (distance < hit_threshold(r, scene));
  at->steps[k] += SELECT(at->asked & NOT(met), REAL(1), REAL(0));
  mask spent = at->asked & NOT(met) & NOT(at->steps[k] < REAL(max_steps));
  at->end = SELECT(met | spent, t, at->end);
  at->met = (at->met & NOT(spent)) | met;
  real left = most - t;
  t += SELECT(distance > left, left, distance);
  t = SELECT(met | spent | (t > at->leave[k]), REAL(INFINITY), t);
  at->t[k] = SELECT(at->asked, t, at->t[k]);
  // A NaN ends the lane.
  mask lost = at->asked & NOT(distance == distance);
  at->end = SELECT(lost, distance, at->end);

  // The lane has ended where no component is left before its end.
  before = SELECT(at->end < most, at->end, most);
  mask ended = r.active & (NOT(nearest_of(at) < before) | lost);
  r.hit |= ended & at->met & NOT(lost);
  r.spent |= ended & NOT(at->met) & (at->end < most);
  r.active &= NOT(ended);
  r.steps += SELECT(at->asked & r.active, REAL(1), REAL(0));
  // A ray that ends far away without a step has made one: it is known to be marched (rendering.py).
  r.steps = SELECT(ended & NOT(r.hit), fmax(r.steps, REAL(1)), r.steps);
  return r;
}
