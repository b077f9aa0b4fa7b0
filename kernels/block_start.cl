// block_start.cl - the entry point for starts by blocks (kernel-reflection sequences, section 10): the ray through the middle of a block of
// 4x4 pixels is marched as long as the balls that are free about it hold the rays of all its pixels; from there each goes on by
// itself. Pixels are numbered block by block, so that one lane marches one block. In e3, whole space, where straight lines from one
// eye spread as their length; `trace_blocks` runs before trace_packet or trace_refill, for each sample.

// The middle of a block from the middle of its first pixel, in pixels.
#define BLOCK_MIDDLE C(1.5)
// A step that gains less than so many times the width of the block is left to the pixels: 16 of them share what one step costs, but
// the room is as good as used up.
#define BLOCK_WORTH 2
// How far apart directions are computed to be, in units of rounding, when they are one.
#define BLOCK_ROUNDING 8
// Of how far rays go a block goes no more than this, so that each pixel makes the last step itself and is known to be marched.
#define BLOCK_END C(0.99)

__kernel void trace_blocks(__global scalar *records, int stride, TILE, int max_steps, SCENE_ARGUMENTS)
{
  scene_data scene = {numbers, next_cell, seen_from, texels};
  int_lanes block;
  block.lanes = (int)get_global_id(0) * LANES + LANE_IDS;
  int blocks = width >> 2;
  lane_int row = block.lanes / blocks, column = block.lanes - row * blocks;
  real x = TO_REAL(column * 4 + left), y = TO_REAL(row * 4 + top), middle = REAL(BLOCK_MIDDLE);
  ray r = view_ray(x + middle + REAL(shift_x), y + middle + REAL(shift_y), scene);
  r.active = (x < REAL(right)) & (y < REAL(bottom));

  // A cone about the middle is convex in the picture: no pixel is farther from it than one in a corner.
  real apart = REAL(0);
  for (int corner = 0; corner < 4; corner++) {
    real aside = REAL(2 * (corner & 1)) * middle, below = REAL(corner & 2) * middle;
    vector d = add_scaled_4(view_ray(x + aside + REAL(shift_x), y + below + REAL(shift_y), scene).v, r.v, REAL(-1));
    apart = fmax(apart, sqrt(dot_4(d, d)));
  }
  apart += REAL(BLOCK_ROUNDING * EPSILON);

  real asked = REAL(0), end = REAL(BLOCK_END) * number(scene, FAR);
  for (int i = 0; i < max_steps && ANY(r.active); i++) {
    // At t the rays are t * apart from the middle one at most, and none comes nearer to the scene than the threshold.
    real spread = r.t * apart, threshold = hit_threshold(r, scene);
    real step = (scene_clearance(r.p, scene_distance(r.p, r.v, scene), scene) - spread - threshold) / (REAL(1) + apart);
    asked += SELECT(r.active, REAL(1), REAL(0));
    r.active &= (step > fma(REAL(BLOCK_WORTH), spread, threshold)) & (r.t < end);
    r = moved_by(r, SELECT(r.active, fmin(step, end - r.t), REAL(0)), scene);
  }

  real_lanes t = {r.t}, share = {asked * REAL(C(1.0) / 16)};
#ifdef COMPONENTS
  share.lanes *= REAL(COMPONENTS);
#endif
  for (int lane = 0; lane < LANES; lane++)
    for (int pixel = 0; pixel < 16; pixel++) {
      size_t id = (size_t)block.at[lane] * 16 + pixel;
      records[(size_t)RECORD_T * stride + id] = t.at[lane];
      records[(size_t)RECORD_SHARE * stride + id] = share.at[lane];
    }
}
