// ball_set.h - the union of `count` balls of one radius; centres stand in the scene's numbers, 4 each. Needs ball.h.
// Surface coordinates, those of the nearest ball, where the distance is costly or points have five coordinates.
#if defined(COSTLY_DISTANCE) || HOMOGENEOUS == 5
// The point as the ball about this centre sees it.
FN point from_centre(point p, scene_data scene, int centre) { return untranslate(four_numbers(scene, centre), p); }

FN real ball_set_distance(point p, scene_data scene, int centres, int count, real radius)
{
  real least = ball_distance(from_centre(p, scene, centres), radius);
  for (int i = 1; i < count; i++) least = fmin(least, ball_distance(from_centre(p, scene, centres + 4 * i), radius));
  return least;
}

FN surface ball_set_surface(point p, scene_data scene, int centres, int count, real radius)
{
  surface best = {REAL(INFINITY), {REAL(0), REAL(0), REAL(0), REAL(0)}, REAL(0), REAL(0)};
  for (int i = 0; i < count; i++) {
    point q = from_centre(p, scene, centres + 4 * i);
#ifdef COSTLY_DISTANCE
    // Translations leave the components in a left-invariant frame alone.
    surface s = ball_surface(q, radius);
#else
    // The gradient of -<c, p>, brought to that of half the squared distance in the factor.
    __constant const scalar *c = scene.numbers + centres + 4 * i;
    real arc, ratio = arc_over_sine(q, &arc);
    surface s = {ball_distance(q, radius),
                 {REAL(-c[0]) * ratio, REAL(-c[1]) * ratio, REAL(-CURVATURE * c[2]) * ratio, q.w}, REAL(0), REAL(0)};
#endif
    best = union_of(s, best);
  }
  return best;
}

#else
// Distance grows with the chord, so one chord a ball is compared and one arc taken.
// ACCURACY: in h3 the chord loses EPSILON w^2: in float 2e-6 at 3 from the origin, 1.7e-5 at 5, 5e-4 at 8.
FN real chord_square(point p, scene_data scene, int centre)
{
  __constant const scalar *c = scene.numbers + centre;
  vector d = {p.x - REAL(c[0]), p.y - REAL(c[1]), p.z - REAL(c[2]), p.w - REAL(c[3])};
  return inner(p, d, d);
}

// Arc length over a chord: t, 2 asin(c/2), 2 asinh(c/2).
FN real arc_of_chord(real square)
{
#if CURVATURE == 0
  return sqrt(square);
#else
  return REAL(2) * arc_of_sine(REAL(C(0.5)) * sqrt(fmax(square, REAL(0))));
#endif
}

FN real ball_set_distance(point p, scene_data scene, int centres, int count, real radius)
{
  real least = chord_square(p, scene, centres);
  for (int i = 1; i < count; i++) least = fmin(least, chord_square(p, scene, centres + 4 * i));
  return arc_of_chord(least) - radius;
}

FN surface ball_set_surface(point p, scene_data scene, int centres, int count, real radius)
{
  real least = REAL(INFINITY);
  covector gradient = {REAL(0), REAL(0), REAL(0), REAL(0)};
  for (int i = 0; i < count; i++) {
    __constant const scalar *c = scene.numbers + centres + 4 * i;
    real square = chord_square(p, scene, centres + 4 * i);
    // The gradient of -<c, p>, up to a positive factor; in e3 of |p - c|^2.
#if CURVATURE == 0
    covector g = {p.x - REAL(c[0]), p.y - REAL(c[1]), p.z - REAL(c[2]), REAL(0)};
#else
    covector g = {REAL(-c[0]), REAL(-c[1]), REAL(-c[2]), REAL(-CURVATURE * c[3])};
#endif
    mask nearer = square < least;
    least = SELECT(nearer, square, least);
    gradient = select_4(nearer, g, gradient);
  }
  surface s = {arc_of_chord(least) - radius, gradient, REAL(0), REAL(0)};
  return s;
}
#endif
