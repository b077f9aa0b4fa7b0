// direction_field.h - nil, sl2, sol: light as if it came along the straight line of coordinates, seen from the surface point as origin
// (paper 5.9, 11.6): a cheap field of directions in place of geodesics. In nil and sol translations keep these lines straight.
FN arrival direction_field(shading s, point light, mask counted)
{
  point q = untranslate(s.p, light);
#if HOMOGENEOUS == 5
  direction to = {q.x, q.y, q.w};
#else
  direction to = first_3(q);
#endif
  real length = sqrt(dot_3(to, to));
  arrival a;
  a.from = scale_3(to, REAL(1) / fmax(length, REAL(TINY)));
  a.length = length;
  a.intensity = REAL(1);
  a.lit = counted & (dot_3(s.normal, a.from) > REAL(0));
  return a;
}
