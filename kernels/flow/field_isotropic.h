// field_isotropic.h - the geodesic equation of e3, s3 and h3 in R^4, along geodesics of unit speed: p'' = -K p (paper 7.1-7.3).
FN motion rate_of(motion m)
{
  motion r = {m.along, scale_4(m.at, REAL(-CURVATURE))};
  return r;
}
FN motion kept(motion m) { return m; }
FN real turns_between(motion before, motion after) { return REAL(0); }

// A point that may be far off the model, put back on it.
FN point put_back(point p)
{
#if CURVATURE == 1
  return scale_4(p, rsqrt(dot_4(p, p)));
#else
  return on_model(p);
#endif
}
