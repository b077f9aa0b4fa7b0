// sequence.cl - a kernel-reflection sequence over arrays (arrays.h), for the Python API.

// point 0-3 -> distance 0
__kernel void sequence_over_distance(ARRAYS, NUMBERS)
{
  put(sequence_distance(get_4(0, in, stride), of_numbers(numbers), 0), 0, out, stride);
}

// centre 0-3, radius 4 -> whether the ball is free of the model 0
__kernel void sequence_over_unbounding(ARRAYS, NUMBERS)
{
  real distance = sequence_distance(get_4(0, in, stride), of_numbers(numbers), 0);
  put_mask(distance >= component(4, in, stride), 0, out, stride);
}

// point 0-3 -> unit normal, an ambient vector 0-3, part 4
__kernel void sequence_over_surface(ARRAYS, NUMBERS)
{
  point p = get_4(0, in, stride);
  surface s = sequence_surface(p, of_numbers(numbers), 0);
  direction g = pull_covector(p, s.gradient);
  put_4(push(p, scale_3(g, rsqrt(dot_3(g, g)))), 0, out, stride);
  put(s.part, 4, out, stride);
}
