// march/loop.h - marches rays to their end, whichever tracer makes the steps.

// Marches the active lanes until the last has ended. Not inlined: rays of all kinds share it. The loop works on a copy, which stays in
// registers.
SOLVER void march(ray *from, real limit, int max_steps, scene_data scene)
{
  ray r = *from;
  progress at = begin(r, scene);
  while (ANY(r.active)) r = march_step(r, &at, limit, max_steps, scene);
  *from = arrived(r, at);
}

// Marches until of the lanes that `owns` names `enough` have ended, or all. Not inlined, as march.
SOLVER void march_some(ray *from, progress *with, mask owns, int enough, int max_steps, scene_data scene)
{
  ray r = *from;
  progress at = *with;
  do {
    r = march_step(r, &at, number(scene, FAR), max_steps, scene);
  } while (COUNT(owns & NOT(r.active)) < enough && ANY(r.active));
  *from = r;
  *with = at;
}
