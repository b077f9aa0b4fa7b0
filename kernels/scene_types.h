// scene_types.h - what the generated part of a scene and the marcher say to each other.
//
// All numbers of a scene stand in one constant buffer, so that moving things needs no rebuild. Tables of cells, empty unless
// rays keep track of theirs: next_cell has, row by row, the cell behind each wall; seen_from has, for each light that is not
// repeated, its place as seen from each cell (4 numbers). texels has the images, empty where there are none (pattern/image.h).
typedef struct {
  __constant const scalar *numbers;
  __global const int *next_cell;
  __global const scalar *seen_from;
  __global const scalar *texels;
  int skipped;  // the number of the lamp that is left out of distances, or 0
} scene_data;

// The scene numbers every program has, first in the buffer.
#define HIT_THRESHOLD 0
#define FAR 1
// The angle between the rays of neighbouring pixels.
#define PIXEL_ANGLE 2

FN real number(scene_data scene, int k) { return REAL(scene.numbers[k]); }

// A surface near a point: signed distance, its gradient (a covector in the coordinates of the point), two coordinates on it, and
// where objects have parts of different materials which part it belongs to.
typedef struct {
  real distance;
  covector gradient;
  real u, v;
#ifdef PARTS
  real part;
#endif
} surface;

FN surface nearer_of(surface a, surface b, mask take_a)
{
  surface s = {SELECT(take_a, a.distance, b.distance), select_4(take_a, a.gradient, b.gradient),
               SELECT(take_a, a.u, b.u), SELECT(take_a, a.v, b.v)};
#ifdef PARTS
  s.part = SELECT(take_a, a.part, b.part);
#endif
  return s;
}
FN surface union_of(surface a, surface b) { return nearer_of(a, b, a.distance < b.distance); }
FN surface intersection_of(surface a, surface b) { return nearer_of(a, b, a.distance > b.distance); }
FN surface complement_of(surface a)
{
  a.distance = -a.distance;
  a.gradient = scale_4(a.gradient, REAL(-1));
  return a;
}

// One row of a matrix of the buffer times a point; the fifth homogeneous coordinate, where there is one, is 1.
FN real row_times(__constant const scalar *m, point p)
{
#if HOMOGENEOUS == 5
  return fma(REAL(m[0]), p.x, fma(REAL(m[1]), p.y, fma(REAL(m[2]), p.z, fma(REAL(m[3]), p.w, REAL(m[4])))));
#else
  return fma(REAL(m[0]), p.x, fma(REAL(m[1]), p.y, fma(REAL(m[2]), p.z, REAL(m[3]) * p.w)));
#endif
}

// An isometry of the buffer, the first four rows of its matrix, applied to a point.
FN point apply(scene_data scene, int isometry, point p)
{
  __constant const scalar *m = scene.numbers + isometry;
  point q = {row_times(m, p), row_times(m + HOMOGENEOUS, p), row_times(m + 2 * HOMOGENEOUS, p),
             row_times(m + 3 * HOMOGENEOUS, p)};
#ifdef FIBRE_GAIN
  q = with_fibre_gain(p, q, REAL(m[10]), REAL(m[11]), REAL(m[12]), REAL(m[18]));
#endif
  return q;
}

// A 4x4 matrix of the buffer applied to a vector: what an isometry makes of the vectors of its geometry.
FN vector apply_linear(scene_data scene, int matrix, vector v)
{
  __constant const scalar *m = scene.numbers + matrix;
  vector r;
  r.x = fma(REAL(m[0]), v.x, fma(REAL(m[1]), v.y, fma(REAL(m[2]), v.z, REAL(m[3]) * v.w)));
  r.y = fma(REAL(m[4]), v.x, fma(REAL(m[5]), v.y, fma(REAL(m[6]), v.z, REAL(m[7]) * v.w)));
  r.z = fma(REAL(m[8]), v.x, fma(REAL(m[9]), v.y, fma(REAL(m[10]), v.z, REAL(m[11]) * v.w)));
  r.w = fma(REAL(m[12]), v.x, fma(REAL(m[13]), v.y, fma(REAL(m[14]), v.z, REAL(m[15]) * v.w)));
  return r;
}

// A covector pulled back by the same matrix: the gradient of f o isometry from the gradient of f.
FN covector pull_back(scene_data scene, int matrix, covector g)
{
  __constant const scalar *m = scene.numbers + matrix;
  covector r;
  r.x = fma(REAL(m[0]), g.x, fma(REAL(m[4]), g.y, fma(REAL(m[8]), g.z, REAL(m[12]) * g.w)));
  r.y = fma(REAL(m[1]), g.x, fma(REAL(m[5]), g.y, fma(REAL(m[9]), g.z, REAL(m[13]) * g.w)));
  r.z = fma(REAL(m[2]), g.x, fma(REAL(m[6]), g.y, fma(REAL(m[10]), g.z, REAL(m[14]) * g.w)));
  r.w = fma(REAL(m[3]), g.x, fma(REAL(m[7]), g.y, fma(REAL(m[11]), g.z, REAL(m[15]) * g.w)));
  return r;
}

FN real3_lanes three_numbers(scene_data scene, int k)
{
  real3_lanes c = {number(scene, k), number(scene, k + 1), number(scene, k + 2)};
  return c;
}

FN real4_lanes four_numbers(scene_data scene, int k) { return with_w(three_numbers(scene, k), number(scene, k + 3)); }

// How a surface answers light: Phong's three shares and exponent; and how much of what is seen it mirrors.
typedef struct {
  real3_lanes color;
  real ambient, diffuse, specular, shininess;
#ifdef REFLECTIONS
  real reflectivity;
#endif
} material;

FN material select_material(mask m, material a, material b)
{
  material r = {select_3(m, a.color, b.color), SELECT(m, a.ambient, b.ambient), SELECT(m, a.diffuse, b.diffuse),
                SELECT(m, a.specular, b.specular), SELECT(m, a.shininess, b.shininess)};
#ifdef REFLECTIONS
  r.reflectivity = SELECT(m, a.reflectivity, b.reflectivity);
#endif
  return r;
}

// What is counted of the work behind what a pixel shows, besides the steps of its own ray.
typedef struct { real shadow_steps, reflection_steps, light_solves, distances; } work;
