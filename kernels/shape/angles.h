// angles.h - coordinates on what is round.

// An angle in turns, from 0 to 1; it is 1/2 in the direction of x.
FN real turns(real y, real x) { return fma(arc_tangent_2(y, x), REAL(C(0.15915494309189535)), REAL(C(0.5))); }

FN real across_of(direction u) { return sqrt(fma(u.x, u.x, u.y * u.y)); }

// A globe: longitude in turns and latitude in half turns, both from 0 to 1, of a direction, given also by its part across z.
FN surface on_globe(real distance, covector gradient, direction u, real across)
{
  surface s = {distance, gradient, turns(u.y, u.x), fma(arc_tangent_2(u.z, across), REAL(C(0.31830988618379067)), REAL(C(0.5)))};
  return s;
}
