// steps.h - the geodesic equation integrated over any time, in equal steps of at most FLOW_STEP.

// In units of rounding, how much longer a step may be: a time that is a whole number of steps but for that is not given one more.
#define STEP_SLACK 8
// More steps than this are not made: what they would lead to is not a number.
#define MOST_FLOW_STEPS 1000000

// Moves *y on by the time t, back where it is negative, and adds the turns made on the way to *turns. Not inlined: loops compile faster so.
SOLVER void follow(motion *y, real t, real *turns)
{
  motion now = *y;
  real many = fabs(t) / REAL(FLOW_STEP), steps = fmax(-floor(-many * REAL(1 - STEP_SLACK * EPSILON)), REAL(1)), h = t / steps, turned = *turns;
  mask possible = steps <= REAL(MOST_FLOW_STEPS);
  for (int done = 0; done < MOST_FLOW_STEPS && ANY(possible & (REAL(done) < steps)); done++) {
    mask moving = possible & (REAL(done) < steps);
    motion next = kept(step_of(now, h));
    turned += SELECT(moving, turns_between(now, next), REAL(0));
    now = select_motion(moving, next, now);
  }
  now.at.x = SELECT(possible, now.at.x, REAL(NAN));
  *y = now;
  *turns = turned;
}
