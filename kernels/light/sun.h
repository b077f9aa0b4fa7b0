// sun.h - light from one direction u of the frame, the same everywhere, that does not fade. The geodesics along u are parallel, and keep
// their distance in area: any u in e3; in s2xe, h2xe, nil, sl2 and sol the vertical, which stretches Sol one way as it shrinks it the other.
FN arrival sun(shading s, direction u, mask counted)
{
  u = scale_3(u, rsqrt(dot_3(u, u)));
  arrival a = {u, REAL(0), REAL(1), counted & (dot_3(s.normal, u) > REAL(0))};
  return a;
}
