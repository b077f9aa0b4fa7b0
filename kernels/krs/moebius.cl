// moebius.cl - Moebius maps of R^3 over arrays (arrays.h), for the Python API; the numbers are those of one map.
FN point point_of(int c, __global const scalar *in, int stride) { return with_w(get_3(c, in, stride), REAL(1)); }

// point 0-2 -> image 0-2, factor 3
__kernel void moebius_over_point(ARRAYS, NUMBERS)
{
  real factor;
  put_3(first_3(moebius_image(point_of(0, in, stride), &factor, of_numbers(numbers), 0)), 0, out, stride);
  put(factor, 3, out, stride);
}

// centre 0-2, radius 3 -> centre 0-2, radius 3, whether the inside stays inside 4
__kernel void moebius_over_ball(ARRAYS, NUMBERS)
{
  point c = point_of(0, in, stride);
  real radius = component(3, in, stride);
  mask ok = radius == radius;
  moebius_ball(&c, &radius, &ok, of_numbers(numbers), 0);
  put_3(first_3(c), 0, out, stride);
  put(radius, 3, out, stride);
  put_mask(ok, 4, out, stride);
}

// point 0-2, covector at its image 3-5 -> covector at the point 0-2
__kernel void moebius_over_pull_back(ARRAYS, NUMBERS)
{
  covector g = with_w(get_3(3, in, stride), REAL(0));
  put_3(first_3(moebius_pull_back(g, point_of(0, in, stride), of_numbers(numbers), 0)), 0, out, stride);
}
