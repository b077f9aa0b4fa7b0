// footprint.h - what a pixel sees of a surface: the width of its beam, and the area of the surface that this covers.
//
// A beam is as wide as the pixel's angle times the root of the area density (paper 5.7, 7.5), and covers the more of the surface
// the more it grazes. Behind a mirror the way is taken as if it were one geodesic as long: right for flat mirrors of isotropic
// geometries, elsewhere a pattern may be too sharp or too soft.

// `spread` is the area in surface coordinates, where a pattern asks for it.
typedef struct { real width, area, spread; } footprint;

// Of the ray that arrives at p along v, after the length t, on a surface with this gradient.
FN footprint footprint_of(point p, vector v, real t, covector gradient, scene_data scene)
{
  direction back = pull(p, v), normal = pull_covector(p, gradient);
  back = scale_3(back, -rsqrt(dot_3(back, back)));
  // The area density of a geodesic is the same both ways.
  footprint f;
  f.width = number(scene, PIXEL_ANGLE) * sqrt(fabs(area_density(back, t, REAL(0))));
  f.area = f.width * f.width / fabs(dot_3(back, normal) * rsqrt(dot_3(normal, normal)));
  f.spread = REAL(0);
  return f;
}
