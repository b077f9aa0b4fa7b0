// special.cl - elliptic integrals and functions over arrays (arrays.h), for the Python API. One kernel a function.

// From component c, which is m = k^2 or, where complementary, m1 = k'^2, and its tail after it. Neither modulus loses digits.
FN agm agm_at(int c, int complementary, __global const scalar *from, int stride)
{
  real given = component(c, from, stride), tail = component(c + 1, from, stride);
  real root = sqrt(given + tail), other = sqrt((REAL(1) - given) - tail);
  return complementary ? agm_of(other, root) : agm_of(root, other);
}

// m or m1 0, its tail 1 -> K 0, E 1
__kernel void special_ke(ARRAYS, int complementary)
{
  agm m = agm_at(0, complementary, in, stride);
  put(m.quarter, 0, out, stride);
  put(complete_second(&m), 1, out, stride);
}

// u 0, m or m1 1, its tail 2 -> sn 0, cn 1, dn 2, zeta 3
__kernel void special_jacobi(ARRAYS, int complementary)
{
  agm m = agm_at(1, complementary, in, stride);
  real cosine, delta, zeta, sine = jacobi_periodic(&m, component(0, in, stride), &cosine, &delta, &zeta);
  put(sine, 0, out, stride);
  put(cosine, 1, out, stride);
  put(delta, 2, out, stride);
  put(zeta, 3, out, stride);
}
