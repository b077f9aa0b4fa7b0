// bisected_half_space.h - nil, sl2: the half-space of horizontal_half_space.h (which has to be pasted too), found without any
// bound of its distance: by a step along the ray and, where that ends on the other side, bisection (paper 9.7, 10.7, 4.2.1).

// Length of the step. What the ray enters and leaves within one is missed: of the boundary only a sliver PROBE^2/8 deep where
// the rate of the level changes by 1 per unit of length.
#define PROBE C(0.125)
// Halvings that leave of the step what rounding makes of it.
#ifdef FP64
#define HALVINGS 53
#else
#define HALVINGS 24
#endif

FN surface horizontal_half_space_surface(point q);
FN real horizontal_half_space_clearance(point q, vector v);
FN real bisected_half_space_clearance(point q, vector v) { return horizontal_half_space_clearance(q, v); }
FN surface bisected_half_space_surface(point q) { return horizontal_half_space_surface(q); }

FN real level_after(point q, vector v, real t)
{
  flow(&q, &v, t);
  return horizontal_half_space_surface(q).distance;
}

FN real bisected_half_space_distance(point q, vector v)
{
  real level = horizontal_half_space_surface(q).distance, reached = REAL(PROBE), step = reached;
  mask outside = level > REAL(0), crossing = outside ^ (level_after(q, v, reached) > REAL(0));
  if (ANY(crossing)) {
    // The last point known to lie on the side of q.
    reached = SELECT(crossing, REAL(0), reached);
    for (int i = 0; i < HALVINGS; i++) {
      step *= REAL(C(0.5));
      real further = reached + step;
      mask same_side = crossing & NOT(outside ^ (level_after(q, v, further) > REAL(0)));
      reached = SELECT(same_side, further, reached);
    }
  }
  // Where there is no point there is no side either.
  return SELECT(outside, reached, SELECT(level <= REAL(0), -reached, level));
}
