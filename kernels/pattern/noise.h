// noise.h - a solid texture (KRS paper 8.2) from sums of gradient noise (Perlin, An image synthesizer, 1985): which color has the
// point q of an object, in the coordinates of its own frame?
//
// METHOD. Space is cut into unit cubes; at each corner stands a gradient from a hash of its whole coordinates, and between the corners
// the linear functions of these gradients are joined by a quintic. Octave o is 2^o times as fine, 2^-o times as strong, and shifted,
// so that the zeros at the corners do not meet. The hash is on whole numbers: the same in both precisions and at every width.
// An octave that is finer than the pixel's footprint is long fades, and is left out where it would flicker; and so does one as far out
// as numbers no longer tell the points of a cube apart.
//
// Numbers: the reciprocals of the sizes along x, y and z; the smallest size; the `colors`, evenly spaced from the least value to the
// greatest.
#define NOISE_HEAD 4

// How much of an octave is left falls from 1 where its cubes are this many footprints wide to 0 where they are half as many.
#define NOISE_SHARP_FROM 2

// An octave falls from 1 where a coordinate is half as many cubes from 0 to 0 where it is so many: 2^18, where single precision still
// tells 32 points of an edge apart. Whole numbers of 32 bits would end at 2^31; double does as single does, so that pictures agree.
#define NOISE_FAR C(262144.0)

// The sum of many octaves has the standard deviation 0.22: times this, two of them to each side are all colors.
#define NOISE_GAIN C(1.13)

// By how much an octave is shifted along x, y and z more than the one before it.
#define NOISE_SHIFT_X C(0.37)
#define NOISE_SHIFT_Y C(0.59)
#define NOISE_SHIFT_Z C(0.83)

// Mixes the bits of a whole number: a bijection in which each bit changes half of the others (Wellons, Prospecting for hash
// functions, 2018: lowbias32).
FN lane_uint mixed_bits(lane_uint x)
{
  x ^= x >> 16;
  x *= 0x7feb352dU;
  x ^= x >> 15;
  x *= 0x846ca68bU;
  x ^= x >> 16;
  return x;
}

// The gradient of a hash, in the cube from -1 to 1, times the way (x, y, z) from its corner.
FN real corner_value(lane_uint hash, real x, real y, real z)
{
  real u = UINT_TO_REAL(hash & 1023U), v = UINT_TO_REAL((hash >> 10) & 1023U), w = UINT_TO_REAL((hash >> 20) & 1023U);
  direction from = {x, y, z}, bits = {u - REAL(C(511.5)), v - REAL(C(511.5)), w - REAL(C(511.5))};
  return dot_3(bits, from) * REAL(C(1.0) / C(511.5));
}

FN real faded(real t) { return t * t * t * fma(t, fma(t, REAL(6), REAL(-15)), REAL(10)); }

FN real mixed(real a, real b, real share) { return fma(share, b - a, a); }

// Gradient noise at a point, in units of its cubes; 0 on average, seldom beyond 1.
FN real gradient_noise(real x, real y, real z, uint seed)
{
  real left = floor(x), front = floor(y), below = floor(z);
  x -= left;
  y -= front;
  z -= below;
  lane_uint i = TO_UINT(left), j = TO_UINT(front), k = TO_UINT(below);
  real along_x = faded(x), along_y = faded(y), along_z = faded(z), level[2];
  for (uint up = 0; up < 2; up++) {
    lane_uint of_level = mixed_bits(k + up + seed);
    real row[2];
    for (uint back = 0; back < 2; back++) {
      lane_uint of_row = mixed_bits(j + back + of_level);
      real from_y = y - REAL(back), from_z = z - REAL(up);
      row[back] = mixed(corner_value(mixed_bits(i + of_row), x, from_y, from_z),
                        corner_value(mixed_bits(i + 1U + of_row), x - REAL(1), from_y, from_z), along_x);
    }
    level[up] = mixed(row[0], row[1], along_y);
  }
  return mixed(level[0], level[1], along_z);
}

// How much of an octave is left whose cubes are `size` wide, where a pixel sees the length `covered`.
FN real octave_left(real size, real covered)
{
  real left = REAL(2) * size / (REAL(NOISE_SHARP_FROM) * covered) - REAL(1);
  // What is not a number, where the beam has no width, is as sharp as can be.
  return SELECT(left < REAL(1), fmax(left, REAL(0)), REAL(1));
}

// How much of an octave is left at a coordinate in units of its cubes; 0 of what is no number.
FN real told_apart(real x)
{
  real left = fma(fabs(x), REAL(-2 / NOISE_FAR), REAL(2));
  return SELECT(left > REAL(0), fmin(left, REAL(1)), REAL(0));
}

// The sum of all octaves at q, where a pixel sees the length `covered`.
FN real noise_value(point q, real covered, scene_data scene, int k, int octaves)
{
  real x = q.x * number(scene, k), y = q.y * number(scene, k + 1), z = q.z * number(scene, k + 2);
  real size = number(scene, k + 3), sum = REAL(0), strength = REAL(1);
  for (int octave = 0; octave < octaves; octave++) {
    real shift = REAL(octave), left = octave_left(size, covered);
    real a = fma(shift, REAL(NOISE_SHIFT_X), x), b = fma(shift, REAL(NOISE_SHIFT_Y), y), c = fma(shift, REAL(NOISE_SHIFT_Z), z);
    left *= told_apart(a) * told_apart(b) * told_apart(c);
    mask some = left > REAL(0);
    if (!ANY(some)) break;
    // What is not left has coordinates that no whole number holds.
    real value = gradient_noise(SELECT(some, a, REAL(0)), SELECT(some, b, REAL(0)), SELECT(some, c, REAL(0)), (uint)octave);
    sum = fma(strength * left, value, sum);
    x *= REAL(2);
    y *= REAL(2);
    z *= REAL(2);
    size *= REAL(C(0.5));
    strength *= REAL(C(0.5));
  }
  return sum;
}

SOLVER real3_lanes noise(point q, footprint f, scene_data scene, int k, int octaves, int colors)
{
  // As long as the footprint is where the surface is grazed. In h3 coordinates grow faster than lengths, by no more than w.
  real covered = f.area / f.width * fmax(q.w, REAL(1));
  real value = fma(REAL(NOISE_GAIN), noise_value(q, covered, scene, k, octaves), REAL(C(0.5)));
  real place = fmin(fmax(value, REAL(0)), REAL(1)) * REAL(colors - 1);
  real3_lanes color = three_numbers(scene, k + NOISE_HEAD);
  for (int i = 1; i < colors; i++) {
    real3_lanes next = three_numbers(scene, k + NOISE_HEAD + 3 * i), before = color;
    real share = fmin(fmax(place - REAL(i - 1), REAL(0)), REAL(1));
    color = add_scaled_3(scale_3(before, REAL(1) - share), next, share);
  }
  // A point that is none has no color.
  color.x += REAL(0) * (q.x + q.y + q.z);
  return color;
}
