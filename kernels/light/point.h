// point.h - a point light along its k-th geodesic, with the intensity the geometry gives it: 1/area density (paper 5.7).

// Below this area density a light is as bright as it gets: wave fronts focus (at the light, and at its antipode in s3).
#define AREA_DENSITY_FLOOR C(1e-6)

FN arrival point_light(shading s, point light, int k)
{
  point exact = {REAL(0), REAL(0), REAL(0), REAL(0)};
  arrival a;
  mask arrives = geodesic(s.p, light, exact, exact, k, &a.from, &a.length);
  a.intensity = REAL(1) / fmax(area_density(a.from, a.length, REAL(0)), REAL(AREA_DENSITY_FLOOR));
  a.lit = arrives & (dot_3(s.normal, a.from) > REAL(0));
  return a;
}
