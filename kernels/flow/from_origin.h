// from_origin.h - the flow that rays are marched along, by an integrator: in nil and sl2 and sol from the origin each time, translated to
// where the ray is, so that the error is the same everywhere.
FN point flow_from_origin(direction *u, real t, real tail)
{
  motion y = motion_from_origin(*u);
  real turns = REAL(0);
  follow(&y, t + tail, &turns);
  point p = reached_by(y, turns, u);
  *u = scale_3(*u, rsqrt(dot_3(*u, *u)));
  return p;
}

FN void ray_flow(point *p, vector *v, real t)
{
  direction u = first_3(*v);
  point reached = flow_from_origin(&u, t, REAL(0));
  *p = translate(*p, reached);
  *v = with_w(u, REAL(0));
}
