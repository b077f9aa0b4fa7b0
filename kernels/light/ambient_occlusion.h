// ambient_occlusion.h - how much of the light from everywhere reaches a place: little where objects stand close above it. On the
// geodesic along the normal the distance to the scene is compared with the height, at OCCLUSION_HEIGHTS heights up to a reach; nearer
// ones count more. Numbers: reach; strength.

// A plane shades itself nowhere and a right angle by half its strength at every height, so that few are enough.
#define OCCLUSION_HEIGHTS 5
// A height counts by this factor more than the next one.
#define OCCLUSION_RATIO C(1.6)
// A step that is no longer than a cell is wide leads over few walls.
#define OCCLUSION_TELEPORTS 8

FN real ambient_occlusion(shading s, mask counted, scene_data scene, int k, work *done)
{
  mask lost = counted & NOT(counted);
  real height = REAL(0), step = number(scene, k) / REAL(OCCLUSION_HEIGHTS), hidden = REAL(0);
  scalar weight = 1, sum = 0;
  ray r = new_ray(s.p, push(s.p, s.normal));
  r.active = counted;
  for (int i = 0; i < OCCLUSION_HEIGHTS; i++) {
    flow(&r.p, &r.v, step);
#ifdef IN_QUOTIENT
    for (int pass = 0; pass < OCCLUSION_TELEPORTS && ANY(counted & outside_cell(r.p, scene)); pass++) teleport(&r, scene);
#endif
    reproject(&r.p, &r.v);
    height += step;
    real clear = scene_clearance(r.p, scene_distance(r.p, r.v, scene), scene);
    lost |= NOT(clear == clear);
    done->distances += SELECT(counted, REAL(1), REAL(0));
    // What pokes into another object is hidden, and no more than that.
    hidden += REAL(weight) * fmin(fmax(REAL(1) - clear / height, REAL(0)), REAL(1));
    sum += weight;
    weight /= OCCLUSION_RATIO;
  }
  real left = fmax(REAL(1) - number(scene, k + 1) * hidden / REAL(sum), REAL(0));
  return SELECT(counted, SELECT(lost, REAL(NAN), left), REAL(1));
}
