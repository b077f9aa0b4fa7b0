// mirror.h - the mirrors of a kernel-reflection sequence: folding a point to the negative side of one, and a gradient back
// (KRS paper 3, 8.1; corrected in the heads below).
//
// A mirror is a totally geodesic plane: a linear form n on the ambient coordinates, positive on the side that is folded away,
// and the vector m along which it is reflected, x - 2 (n . x) m with n . m = 1. In e3 the form is u . x - w and m = u; in s3
// m = n; in h3 m = n but for the sign of its last component; over a factor of s2xe and h2xe the same, and a horizontal mirror
// has the form w - c. Numbers in e3: u, w (4); elsewhere n, its constant term, m (9). Then a width.
#if CURVATURE == 0 && HOMOGENEOUS == 4
#define MIRROR_WIDTH 4
FN real mirror_side(point x, scene_data scene, int k)
{
  return dot_3(first_3(x), three_numbers(scene, k)) - number(scene, k + 3);
}
FN vector mirror_normal(scene_data scene, int k) { return with_w(three_numbers(scene, k), REAL(0)); }
FN covector mirror_form(scene_data scene, int k) { return mirror_normal(scene, k); }
#else
#define MIRROR_WIDTH 9
FN covector mirror_form(scene_data scene, int k) { return four_numbers(scene, k); }
FN real mirror_side(point x, scene_data scene, int k) { return dot_4(x, mirror_form(scene, k)) + number(scene, k + 4); }
FN vector mirror_normal(scene_data scene, int k) { return four_numbers(scene, k + 5); }
#endif
#define MIRROR_SIZE (MIRROR_WIDTH + 1)

// The point folded: reflected where it is on the positive side. Branch-free, continuous and 1-Lipschitz.
FN point fold(point x, real side, scene_data scene, int k)
{
  return add_scaled_4(x, mirror_normal(scene, k), REAL(-2) * fmax(side, REAL(0)));
}

// The gradient of f(fold(x)) from that of f at the folded point; share: see reflected_share.
FN covector fold_back(covector g, real share, scene_data scene, int k)
{
  return add_scaled_4(g, mirror_form(scene, k), REAL(-2) * share * dot_4(g, mirror_normal(scene, k)));
}
