// point.h - a point light along its k-th geodesic. How it fades is a file of its own: falloff_*.h.

FN connection geodesic_to_light(point p, point light, int k)
{
  point exact = {REAL(0), REAL(0), REAL(0), REAL(0)};
  return connect_points(p, light, exact, exact, k);
}

FN arrival point_light(shading s, point light, int k, mask counted, work *done)
{
  connection c = geodesic_to_light(s.p, light, k);
  done->light_solves += SELECT(counted, REAL(1), REAL(0));
  arrival a;
  a.from = c.u;
  a.length = SELECT(c.exists, c.length, REAL(INFINITY));
  // A solve that reached its bound is a NaN, which is counted, and not a light from somewhere.
  a.intensity = SELECT(c.unsolved, REAL(NAN), REAL(1));
  a.lit = counted & c.exists & (dot_3(s.normal, a.from) > REAL(0));
  return a;
}
