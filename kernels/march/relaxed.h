// march/relaxed.h - over-relaxed sphere tracing (Keinert et al. 2014): steps longer than the distance, made again where the balls
// about their two ends do not meet, for then something may lie between. In the whole space, with distances that hold all around. It gains
// where rays pass by, and loses where they meet a surface head on: there every second step is made again.

// So much longer than the distance is a step. From 1.4 to 1.6 the count of steps is flat; shorter ones are made again less often.
#define RELAXATION C(1.4)

// The radius of the ball at the start of the last step, and the length of the step; by which factor steps are longer.
typedef struct { real radius, step; mask plain; scalar longer; } progress;
FN progress begin(ray r, scene_data scene)
{
  progress at = {REAL(0), REAL(0)};
  at.plain = NOT(r.t == r.t);
  at.longer = RELAXATION;
  return at;
}
// Where it counts too how near the ray passes what it does not meet, it looks as often as `direct`.
FN progress begin_softly(ray r, scene_data scene)
{
  progress at = begin(r, scene);
  at.longer = 1;
  return at;
}
FN progress select_progress(mask m, progress a, progress b)
{
  progress at = {SELECT(m, a.radius, b.radius), SELECT(m, a.step, b.step)};
  at.plain = (m & a.plain) | (NOT(m) & b.plain);
  at.longer = b.longer;
  return at;
}
FN ray measured(ray before, ray after, progress at) { return before; }
// A ray that is out of steps goes back to where it is known to be free.
FN ray arrived(ray r, progress at)
{
  ray free = r;
  ray_flow(&free.p, &free.v, at.radius - at.step);
  mask back = r.spent & (at.step > at.radius);
  r.p = select_4(back, free.p, r.p);
  r.v = select_4(back, free.v, r.v);
  r.t = SELECT(back, r.t + at.radius - at.step, r.t);
  return r;
}

FN ray march_step(ray r, progress *at, real limit, int max_steps, scene_data scene)
{
  real distance = scene_distance(r.p, r.v, scene);
  r.clear = distance;
  // A step no longer than its ball cannot have gone too far, whatever is found at its end.
  mask too_far = (at->step > at->radius) & (distance + at->radius < at->step);
  mask there = r.active & NOT(too_far) & (distance < hit_threshold(r, scene));
  r.hit |= there;
  r.active &= NOT(there) & (too_far | (r.t < limit));

  // Back to the end of the ball, and from there one plain step.
  real step = SELECT(at->plain, distance, REAL(at->longer) * distance), left = limit - r.t;
  step = SELECT(step > left, left, step);
  step = SELECT(too_far, at->radius - at->step, step);
  at->plain = too_far;
  at->radius = SELECT(too_far, REAL(0), distance);
  at->step = SELECT(too_far, REAL(0), step);
  return count_step(moved_by(r, SELECT(r.active, step, REAL(0)), scene), max_steps);
}
