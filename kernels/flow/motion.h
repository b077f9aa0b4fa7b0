// motion.h - a state of the geodesic equation, for the integrators beside it: what closed forms are measured against (paper, appendix A).
//
// The equation itself, y' = rate_of(y), is field_*.h, one of them in each program, which also says in kept(y) what an invariant puts
// right after each step; step_of(y, h) of euler.h, rk2.h, rk4.h or rk8.h makes one step; steps.h makes as many as it takes;
// from_anywhere.h or from_origin.h puts that in place of the closed form.
typedef struct { point at; vector along; } motion;

FN motion add_motion(motion a, motion b, real k)
{
  motion r = {add_scaled_4(a.at, b.at, k), add_scaled_4(a.along, b.along, k)};
  return r;
}
FN motion select_motion(mask m, motion a, motion b)
{
  motion r = {select_4(m, a.at, b.at), select_4(m, a.along, b.along)};
  return r;
}
