// render.cl - the entry points for pictures: `trace_packet` and `trace_refill` march the rays of one tile and record where
// they end; `shade` turns the records into colour and the other channels. Pixels of a tile are numbered 4x4 block by block,
// so that the rays of a packet are neighbours; the host undoes that.
//
// The generated scene part gives, beside what march.h needs: view_ray(x, y), in_picture(x, y) where the picture is round,
// scene_surface and scene_light, scene_background, scene_clear and scene_air (fog), scene_seen (what a ray shows that has ended,
// with or without reflections).

// A record: t, steps, cell, hit (1), out of steps (2) or miss (0), position, velocity.
#define RECORD_T 0
#define RECORD_STEPS 1
#define RECORD_CELL 2
#define RECORD_END 3
#define RECORD_POINT 4
#define RECORD_VECTOR 8
// Where rays start by blocks, the pixel's share of the distances that its block asked for; until it is marched, t is where it starts.
#define RECORD_SHARE 12

// Channels of a tile. Sums run over the samples of a pixel, the others belong to its first sample.
#define SUM_COLOR 0
#define SUM_STEPS 3
#define SUM_SHADOW_STEPS 4
#define SUM_REFLECTION_STEPS 5
#define SUM_LIGHT_SOLVES 6
#define SUM_DISTANCES 7
#define SUM_HITS 8
#define SUM_NAN 9
#define SUM_OUT_OF_STEPS 10
#define FIRST_DEPTH 11
#define FIRST_NORMAL 12
#define FIRST_STEPS 15
#define FIRST_OBJECT 16
#define FIRST_CELL 17
// Where a picture asks for it.
#define FIRST_ERROR 18

// The place of a tile in the picture, its width with padding, and the place of the sample in its pixel. Pixels of the padding,
// from `right` and `bottom` on, are not marched, nor are those whose middle is outside a round picture.
#define TILE int left, int top, int right, int bottom, int width, scalar shift_x, scalar shift_y
#define SCENE_ARGUMENTS __constant const scalar *numbers, __global const int *next_cell, __global const scalar *seen_from, \
                        __global const scalar *texels
#define TILE_ARGUMENTS left, top, right, bottom, width, shift_x, shift_y

FN ray start(lane_int id, __global const scalar *records, int stride, scene_data scene, TILE)
{
  lane_int inner_id = id & 15, block = id >> 4;
  int blocks = width >> 2;
  lane_int row = block / blocks, column = block - row * blocks;
  real x = TO_REAL(column * 4 + (inner_id & 3) + left), y = TO_REAL(row * 4 + (inner_id >> 2) + top);
  ray r = view_ray(x + REAL(shift_x), y + REAL(shift_y), scene);
  r.active &= (x < REAL(right)) & (y < REAL(bottom));
#ifdef ROUND_PICTURE
  r.active &= in_picture(x + REAL(C(0.5)), y + REAL(C(0.5)), scene);
#endif
#ifdef BLOCK_START
  int_lanes ids;
  real_lanes t;
  ids.lanes = id;
  for (int lane = 0; lane < LANES; lane++) t.at[lane] = records[(size_t)RECORD_T * stride + ids.at[lane]];
  r = moved_by(r, t.lanes, scene);
#endif
  return r;
}

FN real end_of(ray r) { return SELECT(r.hit, REAL(1), SELECT(r.spent, REAL(2), REAL(0))); }

// One work-item marches one packet of LANES neighbouring pixels until the last ray has ended.
__kernel void trace_packet(__global scalar *records, int stride, TILE, int max_steps, SCENE_ARGUMENTS)
{
  scene_data scene = {numbers, next_cell, seen_from, texels};
  size_t packet = get_global_id(0);
  ray r = start((int)packet * LANES + LANE_IDS, records, stride, scene, TILE_ARGUMENTS);
  march(&r, number(scene, FAR), max_steps, scene);
  STORE(r.t, packet, records + (size_t)RECORD_T * stride);
  STORE(r.steps, packet, records + (size_t)RECORD_STEPS * stride);
  STORE(r.cell, packet, records + (size_t)RECORD_CELL * stride);
  STORE(end_of(r), packet, records + (size_t)RECORD_END * stride);
  real4_lanes four[2] = {r.p, r.v};
  for (int k = 0; k < 2; k++) {
    __global scalar *to = records + (size_t)(RECORD_POINT + 4 * k) * stride;
    STORE(four[k].x, packet, to);
    STORE(four[k].y, packet, to + stride);
    STORE(four[k].z, packet, to + 2 * stride);
    STORE(four[k].w, packet, to + 3 * stride);
  }
}

// One work-item owns `chunk` consecutive pixels; when a quarter of its lanes have ended, it records them and gives those
// lanes the next pixels. Better where the lengths of rays in a packet differ much.
__kernel void trace_refill(__global scalar *records, int stride, TILE, int max_steps, SCENE_ARGUMENTS, int chunk)
{
  scene_data scene = {numbers, next_cell, seen_from, texels};
  int first = (int)get_global_id(0) * chunk, next = first + LANES, end = first + chunk;
  int_lanes id;
  id.lanes = first + LANE_IDS;
  ray r = start(id.lanes, records, stride, scene, TILE_ARGUMENTS);
  mask_lanes owns, ended;
  owns.lanes = r.t == r.t;
  progress at = begin(r, scene);
  for (;;) {
    march_some(&r, &at, owns.lanes, (LANES + 3) / 4, max_steps, scene);
    ended.lanes = owns.lanes & NOT(r.active);
    ray e = arrived(r, at);
    real_lanes values[12] = {{e.t}, {e.steps}, {e.cell}, {end_of(e)}, {e.p.x}, {e.p.y}, {e.p.z}, {e.p.w},
                             {e.v.x}, {e.v.y}, {e.v.z}, {e.v.w}};
    for (int lane = 0; lane < LANES; lane++)
      if (ended.at[lane]) {
        for (int c = 0; c < 12; c++) records[(size_t)c * stride + id.at[lane]] = values[c].at[lane];
        if (next < end) id.at[lane] = next++;
        else owns.at[lane] = 0;
      }
    if (!ANY(owns.lanes)) break;
    mask fresh = ended.lanes & owns.lanes;
    if (ANY(fresh)) {
      ray begun = start(id.lanes, records, stride, scene, TILE_ARGUMENTS);
      r.p = select_4(fresh, begun.p, r.p);
      r.v = select_4(fresh, begun.v, r.v);
      r.t = SELECT(fresh, begun.t, r.t);
      r.steps = SELECT(fresh, REAL(0), r.steps);
      r.cell = SELECT(fresh, begun.cell, r.cell);
      r.hit &= NOT(fresh);
      r.active = (fresh & begun.active) | (NOT(fresh) & r.active);
      r.spent &= NOT(fresh);
      at = select_progress(fresh, begin(begun, scene), at);
    }
  }
}

FN void add_to(real v, int channel, int sample, __global scalar *pixels, int stride)
{
  __global scalar *to = pixels + (size_t)channel * stride;
  size_t packet = get_global_id(0);
  STORE(sample == 0 ? v : v + LOAD(packet, to), packet, to);
}

__kernel void shade(__global const scalar *records, __global scalar *pixels, int stride, int sample, int max_steps,
                    SCENE_ARGUMENTS)
{
  scene_data scene = {numbers, next_cell, seen_from, texels};
  size_t packet = get_global_id(0);
  real record[12];
  for (int c = 0; c < 12; c++) record[c] = LOAD(packet, records + (size_t)c * stride);
  point p = {record[RECORD_POINT], record[RECORD_POINT + 1], record[RECORD_POINT + 2], record[RECORD_POINT + 3]};
  vector v = {record[RECORD_VECTOR], record[RECORD_VECTOR + 1], record[RECORD_VECTOR + 2], record[RECORD_VECTOR + 3]};
  ray r = new_ray(p, v);
  r.t = record[RECORD_T];
  r.cell = record[RECORD_CELL];
  // A ray out of steps has come as near to a surface as it could: it is shaded there, and counted.
  r.hit = record[RECORD_END] > REAL(0);
  r.spent = record[RECORD_END] > REAL(1);
  mask out_of_steps = r.spent;
  work done = {REAL(0), REAL(0), REAL(0), record[RECORD_STEPS]};
  done.distances += SELECT(NOT(out_of_steps) & (r.hit | (r.t > REAL(0))), REAL(1), REAL(0));
#ifdef BLOCK_START
  done.distances += LOAD(packet, records + (size_t)RECORD_SHARE * stride);
#endif
  look first;
  real3_lanes seen = scene_seen(r, &first, max_steps, scene, &done);

  // A NaN anywhere is a counted pixel of background.
  real sum = seen.x + seen.y + seen.z + r.t;
  mask bad = NOT(sum == sum);
  seen = select_3(bad, scene_background(scene), seen);
  add_to(seen.x, SUM_COLOR, sample, pixels, stride);
  add_to(seen.y, SUM_COLOR + 1, sample, pixels, stride);
  add_to(seen.z, SUM_COLOR + 2, sample, pixels, stride);
  add_to(record[RECORD_STEPS], SUM_STEPS, sample, pixels, stride);
  add_to(done.shadow_steps, SUM_SHADOW_STEPS, sample, pixels, stride);
  add_to(done.reflection_steps, SUM_REFLECTION_STEPS, sample, pixels, stride);
  add_to(done.light_solves, SUM_LIGHT_SOLVES, sample, pixels, stride);
  add_to(done.distances, SUM_DISTANCES, sample, pixels, stride);
  mask hit = r.hit & NOT(bad);
  add_to(SELECT(hit, REAL(1), REAL(0)), SUM_HITS, sample, pixels, stride);
  add_to(SELECT(bad, REAL(1), REAL(0)), SUM_NAN, sample, pixels, stride);
  // Where fog hides all, nothing is missing.
  out_of_steps &= scene_clear(r.t, scene) > REAL(0);
  add_to(SELECT(out_of_steps, REAL(1), REAL(0)), SUM_OUT_OF_STEPS, sample, pixels, stride);
  if (sample == 0) {
    STORE(SELECT(hit, r.t, REAL(INFINITY)), packet, pixels + (size_t)FIRST_DEPTH * stride);
    STORE(SELECT(hit, first.s.normal.x, REAL(0)), packet, pixels + (size_t)FIRST_NORMAL * stride);
    STORE(SELECT(hit, first.s.normal.y, REAL(0)), packet, pixels + (size_t)(FIRST_NORMAL + 1) * stride);
    STORE(SELECT(hit, first.s.normal.z, REAL(0)), packet, pixels + (size_t)(FIRST_NORMAL + 2) * stride);
    STORE(record[RECORD_STEPS], packet, pixels + (size_t)FIRST_STEPS * stride);
    STORE(SELECT(hit, first.s.object, REAL(0)), packet, pixels + (size_t)FIRST_OBJECT * stride);
    STORE(SELECT(hit, first.cell + REAL(1), REAL(0)), packet, pixels + (size_t)FIRST_CELL * stride);
#ifdef ERROR_CHANNEL
    STORE(error_estimate(r, scene), packet, pixels + (size_t)FIRST_ERROR * stride);
#endif
  }
}
