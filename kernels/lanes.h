// lanes.h - lane types: the only file that knows the precision and the width.
//
// A kernel written on `real`, `mask` and `SELECT` runs LANES rays at once in one work-item. LANES (1, 4, 8, 16, 32, 64) and
// FP64 are build options; width 1 is the reference for the others. OpenCL C stops at 16 lanes, so 32 and 64 are two and four
// vectors of 16 side by side (ext_vector_type, which every clang-based compiler has). Contraction is off: pictures agree
// across devices only if a*b+c is rounded the same way everywhere; where a fused product is wanted, fma says so.
#ifndef LANES
#define LANES 1
#endif
#pragma OPENCL FP_CONTRACT OFF
#ifdef FP64
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#define SCALAR double
#define SCALAR_INT long
#define EPSILON 2.220446049250313e-16
#define TINY 2.2250738585072014e-308
#define C(x) x
#else
#define SCALAR float
#define SCALAR_INT int
#define EPSILON 1.1920929e-07f
#define TINY 1.17549435e-38f
#define C(x) x##f
#endif
#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)
#define FN static inline __attribute__((always_inline))
#define OVERLOADED FN __attribute__((overloadable))
// A call that is not inlined: a solver beside which the call costs nothing, and which would take long to compile at every place.
#define SOLVER static __attribute__((noinline))

typedef SCALAR scalar;
typedef SCALAR_INT scalar_int;

#if LANES == 1
typedef scalar real;
typedef scalar_int mask;
typedef int lane_int;
FN int ANY(mask m) { return m != 0; }
FN int COUNT(mask m) { return m != 0; }
FN mask NOT(mask m) { return !m; }
FN real SELECT(mask m, real a, real b) { return m ? a : b; }
FN real LOAD(size_t packet, __global const scalar *from) { return from[packet]; }
FN void STORE(real v, size_t packet, __global scalar *to) { to[packet] = v; }
FN real TO_REAL(lane_int v) { return (scalar)v; }
FN mask IS_ODD(real k) { return ((int)k & 1) != 0; }
#define LANE_IDS 0

#else
#if LANES < 16
#define NATIVE LANES
#else
#define NATIVE 16
#endif
typedef JOIN(SCALAR, NATIVE) JOIN(real, NATIVE);
typedef JOIN(SCALAR_INT, NATIVE) JOIN(mask, NATIVE);
typedef JOIN(int, NATIVE) JOIN(ints, NATIVE);
#define REAL_N JOIN(real, NATIVE)
#define MASK_N JOIN(mask, NATIVE)
#define INTS_N JOIN(ints, NATIVE)
OVERLOADED int ANY(MASK_N m) { return any(m); }
OVERLOADED REAL_N select_lanes(MASK_N m, REAL_N a, REAL_N b) { return select(b, a, m); }
OVERLOADED REAL_N load_lanes(REAL_N *unused, size_t packet, __global const scalar *from) { return JOIN(vload, NATIVE)(packet, from); }
OVERLOADED void STORE(REAL_N v, size_t packet, __global scalar *to) { JOIN(vstore, NATIVE)(v, packet, to); }
OVERLOADED REAL_N TO_REAL(INTS_N v) { return JOIN(JOIN(convert_, SCALAR), NATIVE)(v); }
OVERLOADED MASK_N IS_ODD(REAL_N k) { return (JOIN(JOIN(convert_, SCALAR_INT), NATIVE)(k) & (MASK_N)(1)) != (MASK_N)(0); }
#if NATIVE == 16
OVERLOADED int COUNT(MASK_N m)
{
  JOIN(SCALAR_INT, 8) a = m.lo + m.hi;
  JOIN(SCALAR_INT, 4) b = a.lo + a.hi;
  return -(int)(b.x + b.y + b.z + b.w);
}
#elif NATIVE == 8
OVERLOADED int COUNT(MASK_N m)
{
  JOIN(SCALAR_INT, 4) b = m.lo + m.hi;
  return -(int)(b.x + b.y + b.z + b.w);
}
#else
OVERLOADED int COUNT(MASK_N m) { return -(int)(m.x + m.y + m.z + m.w); }
#endif

// The few built-ins we use, for two half-width vectors side by side.
#define SPLIT_1(T, f) OVERLOADED T f(T x) { T r; r.lo = f(x.lo); r.hi = f(x.hi); return r; }
#define SPLIT_2(T, f) OVERLOADED T f(T x, T y) { T r; r.lo = f(x.lo, y.lo); r.hi = f(x.hi, y.hi); return r; }
#define SPLIT(R, M, I) \
  OVERLOADED int ANY(M m) { return ANY(m.lo | m.hi); } \
  OVERLOADED int COUNT(M m) { return COUNT(m.lo) + COUNT(m.hi); } \
  OVERLOADED R select_lanes(M m, R a, R b) { R r; r.lo = select_lanes(m.lo, a.lo, b.lo); r.hi = select_lanes(m.hi, a.hi, b.hi); return r; } \
  OVERLOADED void STORE(R v, size_t packet, __global scalar *to) { STORE(v.lo, 2 * packet, to); STORE(v.hi, 2 * packet + 1, to); } \
  OVERLOADED R TO_REAL(I v) { R r; r.lo = TO_REAL(v.lo); r.hi = TO_REAL(v.hi); return r; } \
  OVERLOADED M IS_ODD(R k) { M m; m.lo = IS_ODD(k.lo); m.hi = IS_ODD(k.hi); return m; } \
  SPLIT_1(R, exp) SPLIT_1(R, log) SPLIT_1(R, sqrt) SPLIT_1(R, rsqrt) SPLIT_1(R, fabs) SPLIT_1(R, rint) SPLIT_1(R, floor) \
  SPLIT_2(R, fmin) SPLIT_2(R, fmax) SPLIT_2(R, copysign) SPLIT_2(R, atan2) \
  OVERLOADED R fma(R x, R y, R z) { R r; r.lo = fma(x.lo, y.lo, z.lo); r.hi = fma(x.hi, y.hi, z.hi); return r; }
#define SPLIT_LOAD(R, H) \
  OVERLOADED R load_lanes(R *unused, size_t packet, __global const scalar *from) \
  { H *type = 0; R r; r.lo = load_lanes(type, 2 * packet, from); r.hi = load_lanes(type, 2 * packet + 1, from); return r; }
#define WIDE(n) \
  typedef SCALAR JOIN(real, n) __attribute__((ext_vector_type(n))); \
  typedef SCALAR_INT JOIN(mask, n) __attribute__((ext_vector_type(n))); \
  typedef int JOIN(ints, n) __attribute__((ext_vector_type(n))); \
  SPLIT(JOIN(real, n), JOIN(mask, n), JOIN(ints, n))
#if LANES >= 32
WIDE(32)
SPLIT_LOAD(real32, real16)
#endif
#if LANES >= 64
WIDE(64)
SPLIT_LOAD(real64, real32)
#endif
typedef JOIN(real, LANES) real;
typedef JOIN(mask, LANES) mask;
typedef JOIN(ints, LANES) lane_int;
#define NOT(m) (~(m))
#define SELECT(m, a, b) select_lanes(m, (real)(a), (real)(b))
#define LOAD(packet, from) load_lanes((real *)0, packet, from)
#define IDS_4(o) (o), (o) + 1, (o) + 2, (o) + 3
#define IDS_16(o) IDS_4(o), IDS_4((o) + 4), IDS_4((o) + 8), IDS_4((o) + 12)
#if LANES == 4
#define LANE_IDS ((lane_int)(IDS_4(0)))
#elif LANES == 8
#define LANE_IDS ((lane_int)(IDS_4(0), IDS_4(4)))
#elif LANES == 16
#define LANE_IDS ((lane_int)(IDS_16(0)))
#elif LANES == 32
#define LANE_IDS ((lane_int)(IDS_16(0), IDS_16(16)))
#else
#define LANE_IDS ((lane_int)(IDS_16(0), IDS_16(16), IDS_16(32), IDS_16(48)))
#endif
#endif

// A constant or a scene number in all lanes; C() keeps double literals out of a float build.
#define REAL(x) ((real)((scalar)(x)))

// One lane at a time, for table look-ups and for refilling finished lanes.
typedef union { real lanes; scalar at[LANES]; } real_lanes;
typedef union { mask lanes; scalar_int at[LANES]; } mask_lanes;
typedef union { lane_int lanes; int at[LANES]; } int_lanes;

// Four lanes-wide numbers, a point or a vector or a covector of the model; three, a direction in a frame.
typedef struct { real x, y, z, w; } real4_lanes;
typedef struct { real x, y, z; } real3_lanes;
typedef real4_lanes point;
typedef real4_lanes vector;
typedef real4_lanes covector;
typedef real3_lanes direction;

FN real dot_3(real3_lanes a, real3_lanes b) { return fma(a.x, b.x, fma(a.y, b.y, a.z * b.z)); }
FN real dot_4(real4_lanes a, real4_lanes b) { return fma(a.x, b.x, fma(a.y, b.y, fma(a.z, b.z, a.w * b.w))); }
FN real3_lanes cross_3(real3_lanes a, real3_lanes b)
{
  real3_lanes r = {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  return r;
}
FN real3_lanes scale_3(real3_lanes a, real k) { real3_lanes r = {k * a.x, k * a.y, k * a.z}; return r; }
FN real4_lanes scale_4(real4_lanes a, real k) { real4_lanes r = {k * a.x, k * a.y, k * a.z, k * a.w}; return r; }
FN real3_lanes add_scaled_3(real3_lanes a, real3_lanes b, real k)
{
  real3_lanes r = {fma(k, b.x, a.x), fma(k, b.y, a.y), fma(k, b.z, a.z)};
  return r;
}
FN real4_lanes add_scaled_4(real4_lanes a, real4_lanes b, real k)
{
  real4_lanes r = {fma(k, b.x, a.x), fma(k, b.y, a.y), fma(k, b.z, a.z), fma(k, b.w, a.w)};
  return r;
}
FN real3_lanes select_3(mask m, real3_lanes a, real3_lanes b)
{
  real3_lanes r = {SELECT(m, a.x, b.x), SELECT(m, a.y, b.y), SELECT(m, a.z, b.z)};
  return r;
}
FN real4_lanes select_4(mask m, real4_lanes a, real4_lanes b)
{
  real4_lanes r = {SELECT(m, a.x, b.x), SELECT(m, a.y, b.y), SELECT(m, a.z, b.z), SELECT(m, a.w, b.w)};
  return r;
}
FN real3_lanes first_3(real4_lanes a) { real3_lanes r = {a.x, a.y, a.z}; return r; }
FN real4_lanes with_w(real3_lanes a, real w) { real4_lanes r = {a.x, a.y, a.z, w}; return r; }
