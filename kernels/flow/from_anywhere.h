// from_anywhere.h - the flow that rays are marched along, by an integrator: in e3, s3, h3 and the products, whose equation in ambient
// coordinates holds wherever the ray is.
FN void ray_flow(point *p, vector *v, real t)
{
  motion y = {*p, *v};
  real turns = REAL(0);
  follow(&y, t, &turns);
  *p = put_back(y.at);
  direction u = pull(*p, y.along);
  *v = push(*p, scale_3(u, rsqrt(dot_3(u, u))));
}

FN point flow_from_origin(direction *u, real t, real tail)
{
  point p = origin();
  vector v = push(p, *u);
  ray_flow(&p, &v, t + tail);
  *u = pull(p, v);
  return p;
}
