// arrays.h - how kernels over arrays, for the Python API, read and write them.
//
// Arrays are component-major: component c of item i stands at [c * stride + i], stride a multiple of LANES, in one input and
// one output buffer. What is called _tail is what single precision cut off an input.
FN real component(int c, __global const scalar *from, int stride) { return LOAD(get_global_id(0), from + (size_t)c * stride); }
FN void put(real v, int c, __global scalar *to, int stride) { STORE(v, get_global_id(0), to + (size_t)c * stride); }
FN real3_lanes get_3(int c, __global const scalar *from, int stride)
{
  real3_lanes r = {component(c, from, stride), component(c + 1, from, stride), component(c + 2, from, stride)};
  return r;
}
FN real4_lanes get_4(int c, __global const scalar *from, int stride)
{
  return with_w(get_3(c, from, stride), component(c + 3, from, stride));
}
FN void put_3(real3_lanes v, int c, __global scalar *to, int stride)
{
  put(v.x, c, to, stride);
  put(v.y, c + 1, to, stride);
  put(v.z, c + 2, to, stride);
}
FN void put_4(real4_lanes v, int c, __global scalar *to, int stride)
{
  put_3(first_3(v), c, to, stride);
  put(v.w, c + 3, to, stride);
}
FN void put_mask(mask m, int c, __global scalar *to, int stride) { put(SELECT(m, REAL(1), REAL(0)), c, to, stride); }
#define ARRAYS __global const scalar *in, __global scalar *out, int stride
