// lane_integers.h - unsigned whole numbers of 32 bits side by side, for hashes: the same bits at every width and precision.
//
// Beside lanes.h the only file that knows the width; in a program only where something is hashed.
#if LANES == 1
typedef uint lane_uint;
FN lane_uint TO_UINT(real whole) { return (uint)(int)whole; }
FN real UINT_TO_REAL(lane_uint v) { return (scalar)v; }
#else
typedef JOIN(uint, NATIVE) JOIN(uints, NATIVE);
OVERLOADED JOIN(uints, NATIVE) TO_UINT(REAL_N whole)
{
  return JOIN(as_uint, NATIVE)(JOIN(convert_int, NATIVE)(whole));
}
OVERLOADED REAL_N UINT_TO_REAL(JOIN(uints, NATIVE) v) { return JOIN(JOIN(convert_, SCALAR), NATIVE)(v); }
#define SPLIT_INTEGERS(n) \
  typedef uint JOIN(uints, n) __attribute__((ext_vector_type(n))); \
  OVERLOADED JOIN(uints, n) TO_UINT(JOIN(real, n) whole) \
  { JOIN(uints, n) r; r.lo = TO_UINT(whole.lo); r.hi = TO_UINT(whole.hi); return r; } \
  OVERLOADED JOIN(real, n) UINT_TO_REAL(JOIN(uints, n) v) \
  { JOIN(real, n) r; r.lo = UINT_TO_REAL(v.lo); r.hi = UINT_TO_REAL(v.hi); return r; }
#if LANES >= 32
SPLIT_INTEGERS(32)
#endif
#if LANES >= 64
SPLIT_INTEGERS(64)
#endif
typedef JOIN(uints, LANES) lane_uint;
#endif
