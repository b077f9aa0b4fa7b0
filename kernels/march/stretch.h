// march/stretch.h - the stretch of a straight ray that lies within a ball, in e3: what is held by the ball is met there or nowhere.
typedef struct { real enter, leave; } stretch;

FN stretch everywhere(void)
{
  stretch s = {REAL(0), REAL(INFINITY)};
  return s;
}

// The ball of the buffer (centre, radius), larger by what counts as a hit at its far end. A ray that misses it enters at +infinity.
FN stretch stretch_in_ball(ray r, scene_data scene, int k)
{
  direction from = add_scaled_3(first_3(r.p), three_numbers(scene, k), REAL(-1)), v = first_3(r.v);
  real along = -dot_3(from, v), radius = number(scene, k + 3);
  radius += threshold_at(r.before + r.t + sqrt(dot_3(from, from)) + radius, scene);
  direction nearest = add_scaled_3(from, v, along);
  real square = fma(radius, radius, -dot_3(nearest, nearest)), half_chord = sqrt(fmax(square, REAL(0)));
  mask missed = (square < REAL(0)) | (along + half_chord < REAL(0));
  stretch s = {SELECT(missed, REAL(INFINITY), fmax(along - half_chord, REAL(0))), along + half_chord};
  return s;
}
