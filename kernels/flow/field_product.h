// field_product.h - the geodesic equation of s2xe and h2xe along geodesics of unit speed: w'' = 0, and that of the factor at the speed that
// w' leaves it, y'' = -K (1 - w'^2) y (paper 8.1).
FN motion rate_of(motion m)
{
  real l_square = (REAL(1) - m.along.w) * (REAL(1) + m.along.w);
  motion r = {m.along, over(scale_4(factor(m.at), REAL(-CURVATURE) * l_square), REAL(0))};
  return r;
}
FN motion kept(motion m) { return m; }
FN real turns_between(motion before, motion after) { return REAL(0); }

// A point that may be far off the model, put back on it.
FN point put_back(point p)
{
  point y = factor(p);
#if CURVATURE == 1
  return over(scale_4(y, rsqrt(dot_4(y, y))), p.w);
#else
  return over(factor_on_model(y), p.w);
#endif
}
