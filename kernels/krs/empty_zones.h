// empty_zones.h - balls out of which a sequence is cut (KRS paper 8.4): rays that are inside one go straight to where they leave it.
// Numbers from k: centre (3) and radius of each of `count` balls.

// A ray leaves a zone by this much more than it has to, in units of rounding: without it the point could still count as inside.
#define ZONE_SLACK 64

// The way along v to where the zones that hold q end, or the distance d to the model where none does; inside the model no deeper than
// the zones are near, for who goes through what is not the model.
FN real way_through_zones(real d, point q, vector v, scene_data scene, int k, int count)
{
  for (int i = 0; i < count; i++) {
    direction from = add_scaled_3(first_3(q), three_numbers(scene, k + 4 * i), REAL(-1));
    real along = dot_3(from, first_3(v)), radius = number(scene, k + 4 * i + 3);
    real square = dot_3(from, from), inside = fma(radius, radius, -square), depth = radius - sqrt(square);
    d = SELECT(d < depth, depth, d);
    real way = sqrt(fma(along, along, fmax(inside, REAL(0)))) - along + REAL(ZONE_SLACK * EPSILON) * coordinate_size(q);
    // A NaN is kept.
    d = SELECT((inside > REAL(0)) & (d == d), fmax(way, d), d);
  }
  return d;
}

// The distance to what is left, in all directions.
FN real clear_of_zones(real d, point q, scene_data scene, int k, int count)
{
  for (int i = 0; i < count; i++) {
    direction from = add_scaled_3(first_3(q), three_numbers(scene, k + 4 * i), REAL(-1));
    real depth = number(scene, k + 4 * i + 3) - sqrt(dot_3(from, from));
    d = SELECT(d < depth, depth, d);
  }
  return d;
}

// The surface of what is left: of the model, or where it was cut.
FN surface surface_left(surface s, point q, scene_data scene, int k, int count)
{
  for (int i = 0; i < count; i++) {
    direction from = add_scaled_3(first_3(q), three_numbers(scene, k + 4 * i), REAL(-1));
    surface cut = s;
    cut.distance = number(scene, k + 4 * i + 3) - sqrt(dot_3(from, from));
    cut.gradient = with_w(scale_3(from, REAL(-1)), REAL(0));
    s = intersection_of(s, cut);
  }
  return s;
}
