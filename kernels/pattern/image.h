// image.h - an image as the colour of a surface: which colour does the pixel see, of the image and its halvings?
//
// METHOD. From how fast the surface coordinates change there follows how many texels the footprint of the pixel holds
// (footprint.h), and from this the level of the pyramid whose texels are as large: bilinear look-up in the two levels around it,
// and in between by the logarithm of the size (Williams, Pyramidal parametrics, 1983). One area, not two widths: near the poles of
// a globe, where the texels crowd, it stays sharp.
//
// Numbers of an image, from k: how many levels; 1 where v ends at the poles, 0 where it repeats as u does everywhere; the size of the
// image, in units of u and of v; for each level, the largest first, the place of its first texel in scene.texels, in pages and beyond
// them (in single precision the sum would not be exact), its width and its height in texels. Texels are red, green, blue, rows from
// the top, where v is greatest.
#define IMAGE_HEAD 4
#define IMAGE_LEVEL 4
#define TEXEL_PAGE 65536

// Surface coordinates are compared over the width of the beam, and over no more than this: farther away balls have other sides, and
// where their distance is costly no coordinates (ball.h).
#define FOOTPRINT_STEP C(0.015625)

FN real footprint_step(footprint f) { return fmin(f.width, REAL(FOOTPRINT_STEP)); }

// Two directions in the surface with this gradient, at right angles.
FN void directions_in_surface(point q, covector gradient, direction in_surface[2])
{
  direction normal = pull_covector(q, gradient), x = {REAL(1), REAL(0), REAL(0)}, z = {REAL(0), REAL(0), REAL(1)};
  normal = scale_3(normal, rsqrt(dot_3(normal, normal)));
  // The axis that is farther from the normal.
  direction first = cross_3(normal, select_3(fabs(normal.z) > fabs(normal.x), x, z));
  in_surface[0] = scale_3(first, rsqrt(dot_3(first, first)));
  in_surface[1] = cross_3(normal, in_surface[0]);
}

SOLVER point moved_along(point q, direction u, real step)
{
  vector v = push(q, u);
  flow(&q, &v, step);
  return q;
}

// The area in surface coordinates that the footprint has, from the surface at the point and at two points one step beside it. The first
// coordinate of what is round starts again after a turn.
FN real spread_of(surface s, surface beside[2], footprint f)
{
  real du[2], dv[2], step = footprint_step(f);
  for (int i = 0; i < 2; i++) {
    du[i] = beside[i].u - s.u;
    du[i] -= rint(du[i]);
    dv[i] = beside[i].v - s.v;
  }
  return fabs(du[0] * dv[1] - du[1] * dv[0]) / (step * step) * f.area;
}

// Whole texels and what is beyond: the place of `at` between the centres of `count` texels that make one unit.
FN int texel_before(scalar at, int count, scalar *beyond)
{
  scalar x = at * count - C(0.5), before = floor(x);
  *beyond = x - before;
  // Not a number is converted to anything.
  return min(max((int)before, -1), count - 1);
}

FN int texel_index(int i, int count, int ends) { return i < 0 ? (ends ? 0 : count - 1) : i < count ? i : ends ? count - 1 : 0; }

FN scalar between(scalar a, scalar b, scalar share) { return fma(share, b - a, a); }

// One lane: the colour at (u, v), in units of the image, bilinear in one level.
SOLVER void texel_color(scalar u, scalar v, int level, scene_data scene, int k, scalar color[3])
{
  __constant const scalar *n = scene.numbers + k + IMAGE_HEAD + IMAGE_LEVEL * level;
  int width = (int)n[2], height = (int)n[3], ends = scene.numbers[k + 1] > 0;
  __global const scalar *texels = scene.texels + 3 * ((size_t)n[0] * TEXEL_PAGE + (size_t)n[1]);
  scalar right, down;
  int left = texel_before(u - floor(u), width, &right), top = texel_before(1 - (ends ? v : v - floor(v)), height, &down);
  size_t columns[2] = {texel_index(left, width, 0), texel_index(left + 1, width, 0)};
  size_t rows[2] = {texel_index(top, height, ends), texel_index(top + 1, height, ends)};
  for (int c = 0; c < 3; c++) {
    scalar row[2];
    for (int j = 0; j < 2; j++)
      row[j] = between(texels[3 * (rows[j] * width + columns[0]) + c], texels[3 * (rows[j] * width + columns[1]) + c], right);
    color[c] = between(row[0], row[1], down);
  }
}

// The colour at the surface coordinates (u, v), where a pixel covers the area `spread` of them.
SOLVER real3_lanes image(real u, real v, real spread, scene_data scene, int k)
{
  real across = number(scene, k + 2), up = number(scene, k + 3);
  real texels = spread / (across * up) * number(scene, k + IMAGE_HEAD + 2) * number(scene, k + IMAGE_HEAD + 3);
  // Half the binary logarithm; fmax takes 0 for what is not a number, where the beam has no width.
  real level = fmin(fmax(REAL(C(0.72134752044448170)) * log(texels), REAL(0)), number(scene, k) - REAL(1));
  real_lanes u_of = {u / across}, v_of = {v / up}, level_of = {level}, color[3];
  for (int lane = 0; lane < LANES; lane++) {
    scalar share = level_of.at[lane] - floor(level_of.at[lane]), finer[3], coarser[3];
    int first = (int)level_of.at[lane], last = (int)scene.numbers[k] - 1;
    texel_color(u_of.at[lane], v_of.at[lane], first, scene, k, finer);
    texel_color(u_of.at[lane], v_of.at[lane], min(first + 1, last), scene, k, coarser);
    for (int c = 0; c < 3; c++) color[c].at[lane] = between(finer[c], coarser[c], share);
  }
  real3_lanes seen = {color[0].lanes, color[1].lanes, color[2].lanes};
  return seen;
}
