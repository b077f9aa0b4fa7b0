// moebius_sequence.cl - a Moebius kernel-reflection sequence over arrays (arrays.h), for the Python API.

// point 0-3 -> bound of the distance 0
__kernel void moebius_sequence_over_distance(ARRAYS, NUMBERS)
{
  put(moebius_sequence_distance(get_4(0, in, stride), of_numbers(numbers), 0), 0, out, stride);
}

// centre 0-3, radius 4 -> whether the ball is free of the model 0
__kernel void moebius_sequence_over_unbounding(ARRAYS, NUMBERS)
{
  mask free = moebius_sequence_unbounding(get_4(0, in, stride), component(4, in, stride), of_numbers(numbers), 0);
  put_mask(free, 0, out, stride);
}

// point 0-3 -> unit normal, an ambient vector 0-3, part 4
__kernel void moebius_sequence_over_surface(ARRAYS, NUMBERS)
{
  point p = get_4(0, in, stride);
  surface s = moebius_sequence_surface(p, of_numbers(numbers), 0);
  direction g = pull_covector(p, s.gradient);
  put_4(push(p, scale_3(g, rsqrt(dot_3(g, g)))), 0, out, stride);
  put(s.part, 4, out, stride);
}
