// newton.h - one unknown a lane by Newton's method inside a bracket: no step leaves it, and bisection takes over where one would.
//
// The caller evaluates the residual at `at`, proposes a step (root about at - step), says on which side the root lies and
// where the residual is down to its rounding; the loop ends when no lane is active or at NEWTON_BOUND. Lanes that are then
// still active have not converged: the caller counts them.

// Iterations in any one solve, where the program does not say how many. The most that tests/test_twisted.py sees is 16.
#ifndef NEWTON_BOUND
#ifdef FP64
#define NEWTON_BOUND 64
#else
#define NEWTON_BOUND 40
#endif
#endif
#ifdef FP64
#define NEWTON_TOLERANCE 1e-13
#else
#define NEWTON_TOLERANCE 1e-6f
#endif
// A step below NEWTON_TOLERANCE of the unknown is the last: it is still taken, and being quadratic leaves only rounding.

typedef struct {
  real at, low, high;
  mask active;
} newton;

FN newton newton_start(real at, real low, real high, mask active)
{
  newton n = {at, low, high, active};
  return n;
}

FN void newton_step(newton *n, real step, mask root_is_below, mask rounding_only)
{
  n->high = SELECT(n->active & root_is_below, n->at, n->high);
  n->low = SELECT(n->active & NOT(root_is_below), n->at, n->low);
  real next = n->at - step;
  mask inside = (next > n->low) & (next < n->high);
  mask solved = rounding_only | (fabs(step) <= REAL(NEWTON_TOLERANCE) * n->at) |
                (n->high - n->low <= REAL(EPSILON) * n->high);
  real instead = SELECT(solved, n->at, REAL(C(0.5)) * (n->low + n->high));
  n->at = SELECT(n->active, SELECT(inside, next, instead), n->at);
  n->active &= NOT(solved);
}
