// sol.h - Sol (paper 11), the group whose vertical translations stretch x and shrink y: the model.
//
// Points (x, y, z, 1), origin 0; metric e^{-2z} dx^2 + e^{2z} dy^2 + dz^2. Translation by p is left multiplication, (p)(q) =
// (p_x + e^{p_z} q_x, p_y + e^{-p_z} q_y, p_z + q_z). Frames are left-invariant. Symmetries that fix 0: x -> -x, y -> -y, and
// (x, y, z) -> (y, x, -z). A direction u changes along its geodesic as u' = (u_x u_z, -u_y u_z, u_y^2 - u_x^2), so that
// u_x u_y stays, and so do a = e^{-z} u_x, b = e^z u_y and u_z + a x - b y.
// RANGE. Coordinates overflow at |z| = 88 in float, 709 in double.
// ACCURACY: see sol_flow.h, sol_geodesics.h, sol_light.h.
#define HOMOGENEOUS 4

FN point origin(void) { point o = {REAL(0), REAL(0), REAL(0), REAL(1)}; return o; }

FN point translate(point p, point q)
{
  real stretch = exp(p.z);
  point r = {fma(stretch, q.x, p.x * q.w), fma(REAL(1) / stretch, q.y, p.y * q.w), fma(p.z, q.w, q.z), q.w};
  return r;
}

FN point untranslate(point p, point q)
{
  real stretch = exp(p.z);
  point r = {(q.x - p.x * q.w) / stretch, stretch * (q.y - p.y * q.w), fma(-p.z, q.w, q.z), q.w};
  return r;
}

// d(translation(p)) applied to a direction; and its transpose applied to a gradient in ambient coordinates.
FN vector velocity(point p, direction u)
{
  real stretch = exp(p.z);
  vector v = {stretch * u.x, u.y / stretch, u.z, REAL(0)};
  return v;
}

FN covector gradient_of(point p, covector g)
{
  real stretch = exp(p.z);
  covector r = {stretch * g.x, g.y / stretch, g.z, REAL(0)};
  return r;
}

// Translations keep points on the model, and the direction is normalised here.
FN point on_model(point p) { return p; }
FN void reproject(point *p, vector *v) { *v = unit_speed(*v); }

FN real coordinate_size(point p) { return REAL(1) + fmax(fmax(fabs(p.x), fabs(p.y)), fabs(p.z)); }

// The rate of change of a direction along its geodesic.
FN direction acceleration(direction u)
{
  direction r = {u.x * u.z, -u.y * u.z, (u.y - u.x) * (u.y + u.x)};
  return r;
}
