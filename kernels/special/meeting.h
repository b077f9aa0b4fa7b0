// meeting.h - the first t > 0 at which k C(k t)/S(k t) has fallen to a given ratio, where S, C are sin and cos, or sinh and cosh:
// when a curve C a + (S/k) b, a < 0, comes to 0 for ratio = -b/a. Without cancellation as k -> 0, where t = 1/ratio.
// ACCURACY (maximal error, tests/test_marching.py): 2 EPSILON of the result, for k from 0, also next to ratio = k.

FN real straight_meeting(real ratio) { return SELECT(ratio > REAL(0), REAL(1) / ratio, REAL(INFINITY)); }

// In (0, pi/k), for ratios of both signs.
FN real circular_meeting(real ratio, real k)
{
  mask turns = k > REAL(TINY);
  return SELECT(turns, arc_tangent_2(k, ratio) / SELECT(turns, k, REAL(1)), straight_meeting(ratio));
}

// Never where ratio <= k.
FN real hyperbolic_meeting(real ratio, real k)
{
  mask meets = ratio > k, turns = k > REAL(TINY);
  real t = log_1p(REAL(2) * k / SELECT(meets, ratio - k, REAL(1))) / SELECT(turns, REAL(2) * k, REAL(1));
  return SELECT(meets & turns, t, SELECT(turns, REAL(INFINITY), straight_meeting(ratio)));
}
