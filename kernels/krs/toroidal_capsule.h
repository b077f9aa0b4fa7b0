// toroidal_capsule.h - all points within a radius of an arc of a circle, in e3, as a kernel of a sequence; in curvature form, which
// holds for straight arcs as well as for those over half a circle (docs/krs.md, "Kernels"). Numbers: the middle M of the arc (3); unit
// vectors from the centre to M, along the chord and across both (9); curvature; sine and cosine of half the arc's angle; the end of the arc from M
// in the first two directions (2); radius. Coordinates: the angle about the arc in turns, the length along it.
// ACCURACY: float 5e-7 of the arc's size for every sagitta, 0 included (tests/test_krs_model.py).
#define KRS_TOROIDAL_CAPSULE 4
typedef struct { real chord, out, across; mask beyond; } from_arc;
FN from_arc beside_arc(point x, scene_data scene, int k)
{
  direction d = {x.x - number(scene, k), x.y - number(scene, k + 1), x.z - number(scene, k + 2)};
  from_arc f;
  f.out = dot_3(d, three_numbers(scene, k + 3));
  f.chord = dot_3(d, three_numbers(scene, k + 6));
  f.across = dot_3(d, three_numbers(scene, k + 9));
  f.beyond = fma(number(scene, k + 14), fabs(f.chord), -number(scene, k + 13) * f.out) > number(scene, k + 15);
  return f;
}

FN real krs_toroidal_capsule_distance(point x, scene_data scene, int k)
{
  from_arc f = beside_arc(x, scene, k);
  real root, in_plane = above_bulge(f.out, f.chord * f.chord, number(scene, k + 12), &root);
  real u = fabs(f.chord) - number(scene, k + 15), v = f.out - number(scene, k + 16);
  real square = SELECT(f.beyond, fma(u, u, v * v), in_plane * in_plane);
  return sqrt(fma(f.across, f.across, square)) - number(scene, k + 17);
}

FN surface krs_toroidal_capsule_surface(point x, scene_data scene, int k)
{
  from_arc f = beside_arc(x, scene, k);
  real curvature = number(scene, k + 12), root;
  real in_plane = above_bulge(f.out, f.chord * f.chord, curvature, &root);
  // The direction from the centre in the plane of the arc, of length `root`.
  real right = curvature * f.chord, up = fma(curvature, f.out, REAL(1)), share = in_plane / fmax(root, REAL(TINY));
  real along_chord = SELECT(f.beyond, f.chord - copysign(number(scene, k + 15), f.chord), share * right);
  real along_out = SELECT(f.beyond, f.out - number(scene, k + 16), share * up);
  direction g = scale_3(three_numbers(scene, k + 3), along_out);
  g = add_scaled_3(g, three_numbers(scene, k + 6), along_chord);
  g = add_scaled_3(g, three_numbers(scene, k + 9), f.across);
  // The quotient angle/curvature is the chord itself where the arc is straight.
  real straight = fmax(curvature, sqrt(REAL(TINY)));
  surface s = {krs_toroidal_capsule_distance(x, scene, k), with_w(g, REAL(0)), turns(f.across, in_plane),
               arc_tangent_2(straight * f.chord, up) / straight};
  return s;
}
