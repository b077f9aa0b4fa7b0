// verify/trace.cl - the entry point for single rays of a picture, over arrays of places in it (arrays.h): what each comes to, as
// trace_packet has it. In the program of a method its answer; in double with the exact flow and a tight threshold the truth.
// Places count as in the picture of one eye. Rays that start by blocks (block_start.cl) start at the eye here.

#define SCENE_TABLES __constant const scalar *numbers, __global const int *next_cell, __global const scalar *seen_from, \
                     __global const scalar *texels
// What a trace comes to.
#define VERIFY_MISS 0
#define VERIFY_HIT 1
#define VERIFY_SPENT 2
#define VERIFY_UNMARCHED -1

FN ray verify_start(ARRAYS, scene_data scene)
{
  return view_ray(component(0, in, stride) + component(2, in, stride), component(1, in, stride) + component(3, in, stride), scene);
}

// column 0, row 1, place in the pixel 2-3 -> the point where the ray begins 0-3, its direction in the frame there 4-6
__kernel void verify_view(ARRAYS, SCENE_TABLES)
{
  scene_data scene = {numbers, next_cell, seen_from, texels};
  ray r = verify_start(in, out, stride, scene);
  put_4(r.p, 0, out, stride);
  put_3(pull(r.p, r.v), 4, out, stride);
}

// column 0, row 1, place in the pixel 2-3 -> length 0, steps 1, end 2, point 3-6, velocity 7-10, object 11,
// the fraction of what is seen there that fog leaves 12, where it is asked for the estimate of its error 13
__kernel void verify_trace(ARRAYS, SCENE_TABLES, int max_steps)
{
  scene_data scene = {numbers, next_cell, seen_from, texels};
  ray r = verify_start(in, out, stride, scene);
#ifdef ROUND_PICTURE
  real middle = REAL(C(0.5));
  r.active &= in_picture(component(0, in, stride) + middle, component(1, in, stride) + middle, scene);
#endif
  mask marched = r.active;
  march(&r, number(scene, FAR), max_steps, scene);

  // A ray out of steps shows what it has come nearest to.
  real object = REAL(0), cell = r.cell, end = SELECT(r.hit, REAL(VERIFY_HIT), SELECT(r.spent, REAL(VERIFY_SPENT), REAL(VERIFY_MISS)));
  if (ANY(r.hit | r.spent)) {
    covector gradient;
    material m;
    scene_surface(r.p, r.v, r.t, &object, &cell, &gradient, &m, scene);
  }
  put(r.t, 0, out, stride);
  put(r.steps, 1, out, stride);
  put(SELECT(marched, end, REAL(VERIFY_UNMARCHED)), 2, out, stride);
  put_4(r.p, 3, out, stride);
  put_4(r.v, 7, out, stride);
  put(SELECT(marched & (r.hit | r.spent), object, REAL(0)), 11, out, stride);
#ifdef SKY
  // Behind everything is no fog.
  real far = REAL(0);
#else
  real far = REAL(INFINITY);
#endif
  put(scene_clear(SELECT(r.hit | r.spent, r.t, far), scene), 12, out, stride);
#ifdef VERIFY_ESTIMATE
  put(error_estimate(r, scene), 13, out, stride);
#endif
}
