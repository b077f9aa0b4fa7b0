// rise.h - when may a coordinate of a ray have come to a level, at the soonest? Bounds from its rate there and then, and from what that
// rate can become (paper 12.3), for coordinates along which no distance is known.

// The least t > 0 with f t + f_1 t^2/2 = h > 0, or never.
FN real parabola_time(real f, real f_1, real h)
{
  mask bounded = h < REAL(INFINITY);
  real rise = REAL(2) * SELECT(bounded, h, REAL(0)), square = fma(f, f, rise * f_1), root = sqrt(fmax(square, REAL(0)));
  mask falls = f < REAL(0), never = NOT(bounded) | (square < REAL(0)) | (falls & NOT(f_1 > REAL(0)));
  // Without division by h, which may be too small to be divided by.
  return SELECT(never, REAL(INFINITY), SELECT(falls, root - f, rise) / SELECT(falls, f_1, f + root));
}

// How far a second bound looks, in units of the first: it gains most where that one is 2/3 of the truth, as near a turning point.
#define LOOK_AHEAD C(1.5)
// A lower bound of the time until a coordinate has risen by h > 0, from its rate f, the rate f_1 of that, and the most that f_1 and
// its rate become later: f_1 <= bend; and f_1 + jerk t, by which the height at t <= T is at most f t + (f_1 + jerk T/3) t^2/2.
FN real rise_time(real f, real f_1, real bend, real jerk, real h)
{
  real near = parabola_time(f, bend, h), ahead = REAL(LOOK_AHEAD) * near;
  real later = parabola_time(f, fmin(bend, fma(jerk * REAL(C(0.3333333333333333)), ahead, f_1)), h);
  return fmax(near, fmin(ahead, later));
}

// Up or down, whichever comes first.
FN real level_time_bound(real f, real f_1, real bend, real jerk, real above, real below)
{
  return fmin(rise_time(f, f_1, bend, jerk, above), rise_time(-f, -f_1, bend, jerk, below));
}
