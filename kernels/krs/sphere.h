// sphere.h - the ball about c as a kernel of a sequence. Numbers: c (4), radius. Coordinates: those of a globe.
#define KRS_SPHERE 1
FN real krs_sphere_distance(point x, scene_data scene, int k)
{
#if CURVATURE == 0
  direction d = {x.x - number(scene, k), x.y - number(scene, k + 1), x.z - number(scene, k + 2)};
  return sqrt(dot_3(d, d)) - number(scene, k + 4);
#else
  point exact = {REAL(0), REAL(0), REAL(0), REAL(0)};
  mask unsolved;
  return distance_between(four_numbers(scene, k), x, exact, exact, &unsolved) - number(scene, k + 4);
#endif
}

FN surface krs_sphere_surface(point x, scene_data scene, int k)
{
  point c = four_numbers(scene, k);
#if HOMOGENEOUS == 5
  // Half the gradient of the squared distance, as in shape/ball_set.h.
  point q = untranslate(c, x);
  real arc, ratio = arc_over_sine(q, &arc);
  covector gradient = {-c.x * ratio, -c.y * ratio, REAL(-CURVATURE) * c.z * ratio, q.w};
  direction at_centre = {q.x, q.y, q.w};
#elif CURVATURE == 0
  covector gradient = {x.x - c.x, x.y - c.y, x.z - c.z, REAL(0)};
  direction at_centre = first_3(gradient);
#else
  // Of -<c, x>, which grows with the distance all the way.
  covector gradient = {-c.x, -c.y, -c.z, REAL(-CURVATURE) * c.w};
  direction at_centre = first_3(untranslate(c, x));
#endif
  return on_globe(krs_sphere_distance(x, scene, k), gradient, at_centre, across_of(at_centre));
}
