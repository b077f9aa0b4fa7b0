// rk4.h - one step of Runge and Kutta's rule of order four along a geodesic, what closed forms are measured against: in geometries with
// a left-invariant metric that have `acceleration` (paper 3.2.1, appendix A).
FN void rk4_step(point *p, direction *u, real h)
{
  const scalar way[4] = {0, C(0.5), C(0.5), 1}, weight[4] = {C(0.16666666666666667), C(0.33333333333333333), C(0.33333333333333333),
                                                            C(0.16666666666666667)};
  point at = *p, moved = *p;
  direction along = *u, turned = *u;
  for (int k = 0; k < 4; k++) {
    vector speed = velocity(at, along);
    direction bend = acceleration(along);
    moved = add_scaled_4(moved, speed, REAL(weight[k]) * h);
    turned = add_scaled_3(turned, bend, REAL(weight[k]) * h);
    if (k < 3) {
      at = add_scaled_4(*p, speed, REAL(way[k + 1]) * h);
      along = add_scaled_3(*u, bend, REAL(way[k + 1]) * h);
    }
  }
  *p = moved;
  *u = scale_3(turned, rsqrt(dot_3(turned, turned)));
}
