// falloff_area.h - light fades as the geometry makes it: 1/area density of its wave front (paper 5.7).

// Below this area density a light is as bright as it gets: wave fronts focus (at the light, and where geodesics meet again). At
// intensity 1 it is a million times what a picture shows as white.
#define AREA_DENSITY_FLOOR C(1e-6)

FN real falloff_area(arrival a)
{
  real density = area_density(a.from, a.length, REAL(0));
  // Unlike fmax this keeps a NaN.
  return a.intensity / SELECT(density < REAL(AREA_DENSITY_FLOOR), REAL(AREA_DENSITY_FLOOR), density);
}
