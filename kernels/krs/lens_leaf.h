// lens_leaf.h - what two equal balls have in common, in e3, as a kernel of a sequence: a leaf. Numbers: its middle (3); the unit vector
// across it (3) and two in its plane (6); rim radius b; half thickness h; curvature of its faces 2 h/(b^2 + h^2). Coordinates: those
// in its plane, from 0 to 1 over the rim's square.
#define KRS_LENS_LEAF 5
typedef struct { direction d; real height, axis, spread, square; mask beside_rim; } from_lens;
FN from_lens beside_lens(point x, scene_data scene, int k)
{
  from_lens f;
  f.d.x = x.x - number(scene, k);
  f.d.y = x.y - number(scene, k + 1);
  f.d.z = x.z - number(scene, k + 2);
  f.axis = dot_3(f.d, three_numbers(scene, k + 3));
  f.height = fabs(f.axis);
  real first = dot_3(f.d, three_numbers(scene, k + 6)), second = dot_3(f.d, three_numbers(scene, k + 9));
  f.square = fma(first, first, second * second);
  f.spread = sqrt(f.square);
  real rim = number(scene, k + 12), curvature = number(scene, k + 14);
  // Beyond the cone from the far centre through the rim, both sides over the radius of the faces.
  f.beside_rim = (f.spread - rim) * (REAL(1) - curvature * number(scene, k + 13)) > curvature * f.height * rim;
  return f;
}

FN real krs_lens_leaf_distance(point x, scene_data scene, int k)
{
  from_lens f = beside_lens(x, scene, k);
  real from_rim = f.spread - number(scene, k + 12), y = f.height - number(scene, k + 13), root;
  real from_face = above_bulge(y, f.square, number(scene, k + 14), &root);
  return SELECT(f.beside_rim, sqrt(fma(f.height, f.height, from_rim * from_rim)), from_face);
}

FN surface krs_lens_leaf_surface(point x, scene_data scene, int k)
{
  from_lens f = beside_lens(x, scene, k);
  direction axis = three_numbers(scene, k + 3), in_plane = add_scaled_3(f.d, axis, -f.axis);
  real rim = number(scene, k + 12), curvature = number(scene, k + 14), y = f.height - number(scene, k + 13);
  real outward = SELECT(f.beside_rim, (f.spread - rim) / fmax(f.spread, REAL(TINY)), curvature);
  real up = SELECT(f.beside_rim, f.height, fma(curvature, y, REAL(1)));
  direction g = add_scaled_3(scale_3(in_plane, outward), axis, copysign(up, f.axis));
  real scale = REAL(C(0.5)) / rim;
  surface s = {krs_lens_leaf_distance(x, scene, k), with_w(g, REAL(0)),
               fma(dot_3(f.d, three_numbers(scene, k + 6)), scale, REAL(C(0.5))),
               fma(dot_3(f.d, three_numbers(scene, k + 9)), scale, REAL(C(0.5)))};
  return s;
}
