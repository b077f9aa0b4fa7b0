// verify/carry.cl - the entry point that tells how wrong the point is at which a method says that a ray has hit (paper A.2.2); after
// verify/trace.cl, in the program of the truth.
//
// It follows the exact geodesic of a place for the length of the method's ray, and takes the offset of the method's point apart there:
// a J e1 + b J e2 + c v, where J e1 and J e2 are how the geodesic's point moves as its direction at the eye turns. To first order the
// direction turned by (a, b) has the exact geodesic that comes to the method's point; the host calls again from there (Newton).
//
// METHOD. The Jacobi fields are carried in the frame that moves with the point, as differences to two geodesics beside it that begin
// anew in each step: whatever the curvature they stay small, and no coordinate grows with the length. Over walls they go as vectors
// do. Where they become parallel (conjugate points) the angle is what first order makes of it: large.
// ACCURACY. Fields to 1e-5 of themselves; angles so too where the method's point is near, else to the square of its distance
// (tests/test_accuracy_pictures.py compares with the geodesics that lead to the points).

// How far a geodesic beside another is from it at the start of a step: differences are as exact as this, and rounded to EPSILON over it.
#define VERIFY_ASIDE C(1e-8)
// The longest step: a field grows by so much in it (e^1) that the geodesics stay beside each other.
#define VERIFY_STEP 1
// Teleport passes after a step, at most: a step of length 1 crosses a few walls, in sol one may stand for many.
#define VERIFY_PASSES 64
// How far along the geodesic an image may be that is taken for the least turn of the direction.
#define VERIFY_AHEAD 2
// Rounds in which the method's point is looked for over walls: a point over an edge is over two of them.
#define VERIFY_ROUNDS 2

// The coordinates of a point near the origin along the frame there, and the point at an offset from the origin.
FN direction near_origin(point q)
{
#if HOMOGENEOUS == 5
  direction d = {q.x, q.y, q.w};
  return d;
#else
  return first_3(q);
#endif
}
FN point at_offset(direction d)
{
  real length = sqrt(dot_3(d, d));
  mask none = NOT(length > REAL(TINY));
  direction u = {REAL(0), REAL(0), REAL(1)};
  u = select_3(none, u, scale_3(d, REAL(1) / SELECT(none, REAL(1), length)));
  return exponential(&u, length, REAL(0));
}

// Where q lies from p, in the frame at p: the shortest geodesic's direction times its length, or, where that has to be solved for, what
// it is to first order.
SOLVER direction offset_from(point p, point q)
{
#ifdef COSTLY_DISTANCE
  return near_origin(untranslate(p, q));
#else
  point no_tail = {REAL(0), REAL(0), REAL(0), REAL(0)};
  connection found = connect_points(p, q, no_tail, no_tail, 0);
  return scale_3(found.u, found.length);
#endif
}

// A geodesic's point and unit direction, and of two Jacobi fields along it the value and the derivative, in the frame at the point.
#define FIELDS 2
typedef struct {
  point p;
  direction u, value[FIELDS], change[FIELDS];
} carried;

// Leads the point back into the cell, with all that is at it: each of them is led by the point alone.
#ifdef IN_QUOTIENT
SOLVER void into_cell(carried *from, scene_data scene)
{
  carried c = *from;
  for (int pass = 0; pass < VERIFY_PASSES && ANY(outside_cell(c.p, scene)); pass++) {
    direction all[1 + 2 * FIELDS] = {c.u, c.value[0], c.value[1], c.change[0], c.change[1]};
    point reached = c.p;
    for (int k = 0; k < 1 + 2 * FIELDS; k++) {
      ray r = new_ray(c.p, push(c.p, all[k]));
      teleport(&r, scene);
      reached = r.p;
      all[k] = pull(r.p, r.v);
    }
    c.p = reached;
    c.u = all[0];
    for (int i = 0; i < FIELDS; i++) {
      c.value[i] = all[1 + i];
      c.change[i] = all[1 + FIELDS + i];
    }
  }
  vector v = push(c.p, c.u);
  reproject(&c.p, &v);
  c.u = pull(c.p, v);
  *from = c;
}
#else
FN void into_cell(carried *from, scene_data scene) {}
#endif

FN real greatest_of(direction d) { return fmax(fmax(fabs(d.x), fabs(d.y)), fabs(d.z)); }

// Moves on by the length h, at most VERIFY_STEP.
SOLVER void carry_on(carried *from, real h, scene_data scene)
{
  carried c = *from, next = c;
  direction arriving = c.u;
  point reached = exponential(&arriving, h, REAL(0));
  arriving = scale_3(arriving, unit_correction(dot_3(arriving, arriving)));
  next.p = on_model(translate(c.p, reached));
  next.u = turn_frame(c.p, reached, arriving);
  for (int i = 0; i < FIELDS; i++) {
    real aside = REAL(VERIFY_ASIDE) / fmax(fmax(greatest_of(c.value[i]), greatest_of(c.change[i])), REAL(TINY));
    point beside = at_offset(scale_3(c.value[i], aside));
    direction along = add_scaled_3(c.u, c.change[i], aside);
    along = scale_3(along, REAL(1) / sqrt(dot_3(along, along)));
    point end = exponential(&along, h, REAL(0)), there = translate(beside, end);
    // From the frame at `there` to the one that is carried from `reached`: a turn is undone by that with its points exchanged.
    point from_reached = untranslate(reached, there);
    along = turn_frame(from_reached, reached, turn_frame(beside, end, along));
    direction value = scale_3(near_origin(from_reached), REAL(1) / aside);
    direction change = scale_3(add_scaled_3(along, arriving, REAL(-1)), REAL(1) / aside);
    next.value[i] = turn_frame(c.p, reached, value);
    next.change[i] = turn_frame(c.p, reached, change);
  }
  into_cell(&next, scene);
  mask moves = h > REAL(0);
  c.p = select_4(moves, next.p, c.p);
  c.u = select_3(moves, next.u, c.u);
  for (int i = 0; i < FIELDS; i++) {
    c.value[i] = select_3(moves, next.value[i], c.value[i]);
    c.change[i] = select_3(moves, next.change[i], c.change[i]);
  }
  *from = c;
}

// The direction that u becomes when it is turned by hypot(a, b) towards a e1 + b e2, for e1 and e2 across u.
FN direction turned(direction u, direction e1, direction e2, real a, real b)
{
  real angle = sqrt(fma(a, a, b * b)), c, s = sin_cos(angle, &c);
  mask none = NOT(angle > REAL(TINY));
  real share = SELECT(none, REAL(1), s / SELECT(none, REAL(1), angle));
  return add_scaled_3(add_scaled_3(scale_3(u, c), e1, share * a), e2, share * b);
}

// Two directions across u and each other.
FN direction across(direction u)
{
  direction x = {REAL(1), REAL(0), REAL(0)}, y = {REAL(0), REAL(1), REAL(0)};
  direction least = select_3(fabs(u.x) < fabs(u.y), x, y), e = cross_3(u, least);
  return scale_3(e, REAL(1) / sqrt(dot_3(e, e)));
}

// How much of the fields makes an offset d from the geodesic: a, b; `area` is that of the fields.
FN void unravel(carried c, direction d, real area, real *a, real *b)
{
  mask flat = NOT(fabs(area) > REAL(TINY));
  real inverse = REAL(1) / SELECT(flat, REAL(1), area);
  *a = SELECT(flat, REAL(INFINITY), dot_3(c.u, cross_3(d, c.value[1])) * inverse);
  *b = SELECT(flat, REAL(INFINITY), dot_3(c.u, cross_3(c.value[0], d)) * inverse);
}

// The square of what an image of the method's point is to have the least of: its distance, or the turn to it.
FN real farness(carried c, direction d, real area, int by_turn)
{
  if (!by_turn) return dot_3(d, d);
  real a, b;
  unravel(c, d, area, &a, &b);
  return SELECT(fabs(dot_3(c.u, d)) < REAL(VERIFY_AHEAD), fma(a, a, b * b), REAL(INFINITY));
}

// column 0, row 1, place in the pixel 2-3, turn of the direction 4-5, length 6, the method's point 7-10 and velocity 11-14, how far at
// most that point is from the surface 15 (a bound that holds along the ray alone says less)
// -> turn that is missing 0-1, length that is missing 2, distance to the point 3, area of the fields 4; the point of the surface
// nearest to the method's: turn that is missing to it 5-6, and itself 7-10; products of the fields 11-13
// The buffer has, from `first` on, `images` isometries: the point counts that is nearest of those which they, and then they again, make
// of the method's; or with `by_turn`, of those which they make, the point to which the least turn leads. That is for geodesics which
// part so fast that an error far below a pixel leads many cells aside.
__kernel void verify_carry(ARRAYS, SCENE_TABLES, int first, int images, int by_turn)
{
  scene_data scene = {numbers, next_cell, seen_from, texels};
  ray r = verify_start(in, out, stride, scene);

  // Turn the direction at the eye, and begin the fields of two turns more.
  direction u = pull(r.p, r.v), e1 = across(u), e2 = cross_3(u, e1);
  real a = component(4, in, stride), b = component(5, in, stride);
  carried c;
  c.p = r.p;
  c.u = turned(u, e1, e2, a, b);
  for (int i = 0; i < FIELDS; i++) {
    direction zero = {REAL(0), REAL(0), REAL(0)};
    direction beside = turned(u, e1, e2, a + REAL(i == 0 ? VERIFY_ASIDE : 0), b + REAL(i == 1 ? VERIFY_ASIDE : 0));
    c.value[i] = zero;
    c.change[i] = scale_3(add_scaled_3(beside, c.u, REAL(-1)), REAL(1 / VERIFY_ASIDE));
  }
  into_cell(&c, scene);

  // Carry all of it along the geodesic.
  real left = component(6, in, stride);
  while (ANY(left > REAL(0))) {
    real h = SELECT(left > REAL(0), fmin(left, REAL(VERIFY_STEP)), REAL(0));
    carry_on(&c, h, scene);
    left -= h;
  }

  // The method's point, and the point of the surface nearest to it.
  point q = get_4(7, in, stride);
  vector v = get_4(11, in, stride);
  reproject(&q, &v);
  real object, cell = REAL(0);
  covector gradient;
  material m;
  scene_surface(q, v, component(6, in, stride), &object, &cell, &gradient, &m, scene);
  direction normal = pull_covector(q, gradient);
  real most = component(15, in, stride), down = fmin(fmax(scene_distance(q, v, scene), -most), most);
  point foot = on_model(translate(q, at_offset(scale_3(normal, -down / sqrt(dot_3(normal, normal))))));
  put_4(foot, 7, out, stride);

  // They may stand in another cell.
  real area = dot_3(c.u, cross_3(c.value[0], c.value[1]));
  direction d = offset_from(c.p, q);
  real least = farness(c, d, area, by_turn);
  for (int round = by_turn ? 1 : 0; round < VERIFY_ROUNDS; round++) {
    point from = q, foot_from = foot;
    for (int k = 0; k < images; k++) {
      int isometry = first + 4 * HOMOGENEOUS * k;
      point other = on_model(apply(scene, isometry, from));
      direction offset = offset_from(c.p, other);
      real far = farness(c, offset, area, by_turn);
      mask nearer = far < least;
      if (!ANY(nearer)) continue;
      least = SELECT(nearer, far, least);
      d = select_3(nearer, offset, d);
      q = select_4(nearer, other, q);
      foot = select_4(nearer, on_model(apply(scene, isometry, foot_from)), foot);
    }
  }

  unravel(c, d, area, &a, &b);
  put(a, 0, out, stride);
  put(b, 1, out, stride);
  put(dot_3(c.u, d), 2, out, stride);
  put(sqrt(dot_3(d, d)), 3, out, stride);
  put(fabs(area), 4, out, stride);
  unravel(c, offset_from(c.p, foot), area, &a, &b);
  put(a, 5, out, stride);
  put(b, 6, out, stride);
  put(dot_3(c.value[0], c.value[0]), 11, out, stride);
  put(dot_3(c.value[0], c.value[1]), 12, out, stride);
  put(dot_3(c.value[1], c.value[1]), 13, out, stride);
}
