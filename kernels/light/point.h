// point.h - a point light along its k-th geodesic. How it fades is a file of its own: falloff_*.h.

FN arrival point_light(shading s, point light, int k)
{
  point exact = {REAL(0), REAL(0), REAL(0), REAL(0)};
  connection c = connect_points(s.p, light, exact, exact, k);
  arrival a;
  a.from = c.u;
  a.length = c.length;
  // A solve that reached its bound is a NaN, which is counted, and not a light from somewhere.
  a.intensity = SELECT(c.unsolved, REAL(NAN), REAL(1));
  a.lit = c.exists & (dot_3(s.normal, a.from) > REAL(0));
  return a;
}
