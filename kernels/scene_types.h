// scene_types.h - what the generated part of a scene and the marcher say to each other.
//
// All numbers of a scene stand in one constant buffer, so that moving things needs no rebuild. next_cell is the table of
// cells, row by row: the cell behind each wall (empty unless the scene asks for cell ids).
typedef struct {
  __constant const scalar *numbers;
  __global const int *next_cell;
} scene_data;

// The scene numbers every program has, first in the buffer.
#define HIT_THRESHOLD 0
#define FAR 1

FN real number(scene_data scene, int k) { return REAL(scene.numbers[k]); }

// A surface near a point: signed distance, its gradient (a covector in the coordinates of the point) and two coordinates on it.
typedef struct { real distance; covector gradient; real u, v; } surface;

FN surface nearer_of(surface a, surface b, mask take_a)
{
  surface s = {SELECT(take_a, a.distance, b.distance), select_4(take_a, a.gradient, b.gradient),
               SELECT(take_a, a.u, b.u), SELECT(take_a, a.v, b.v)};
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

// A matrix of the buffer, row by row, applied to a point.
FN point apply(scene_data scene, int matrix, point p)
{
  __constant const scalar *m = scene.numbers + matrix;
  point q;
  q.x = fma(REAL(m[0]), p.x, fma(REAL(m[1]), p.y, fma(REAL(m[2]), p.z, REAL(m[3]) * p.w)));
  q.y = fma(REAL(m[4]), p.x, fma(REAL(m[5]), p.y, fma(REAL(m[6]), p.z, REAL(m[7]) * p.w)));
  q.z = fma(REAL(m[8]), p.x, fma(REAL(m[9]), p.y, fma(REAL(m[10]), p.z, REAL(m[11]) * p.w)));
  q.w = fma(REAL(m[12]), p.x, fma(REAL(m[13]), p.y, fma(REAL(m[14]), p.z, REAL(m[15]) * p.w)));
  return q;
}

// A covector pulled back by a matrix of the buffer: the gradient of f(M p) from the gradient of f.
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

// How a surface answers light: Phong's three shares and exponent.
typedef struct { real3_lanes color; real ambient, diffuse, specular, shininess; } material;

FN material select_material(mask m, material a, material b)
{
  material r = {select_3(m, a.color, b.color), SELECT(m, a.ambient, b.ambient), SELECT(m, a.diffuse, b.diffuse),
                SELECT(m, a.specular, b.specular), SELECT(m, a.shininess, b.shininess)};
  return r;
}
