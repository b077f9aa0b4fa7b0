// horocycle_cylinder.h - sol: the solid cylinder about the x-axis of the object's own coordinates (paper, lemma 11.5), which is no
// geodesic but a horocycle of the plane y = 0. Its distance is that of the plane x = 0.
// Coordinates on it: the angle about the axis in turns, of the geodesic of that plane which leads here; the length along the axis.
FN real horocycle_cylinder_distance(point q, real radius) { return arc_of_excess(excesses_of(q).b) - radius; }

FN surface horocycle_cylinder_surface(point q, real radius)
{
  // Of cosh(distance) = cosh z + e^z y^2/2, in the frame.
  real cosine, rise = sinh_cosh(q.z, &cosine), stretch = exp(q.z), bend = REAL(C(0.5)) * stretch * q.y * q.y;
  covector gradient = {REAL(0), q.y, rise + bend, REAL(0)};
  surface s = {horocycle_cylinder_distance(q, radius), gradient, turns(rise - bend, q.y * stretch), q.x};
  return s;
}
