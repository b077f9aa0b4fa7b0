// euler.h - one step of Euler's rule, of order 1.
FN motion step_of(motion y, real h) { return add_motion(y, rate_of(y), h); }
