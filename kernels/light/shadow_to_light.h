// shadow_to_light.h - the ray to a point light along its k-th geodesic; next to a caustic, where that may have ended just below the
// start, along that from the surface.
FN shadow_ray towards_light(shading s, arrival *a, point light, int k, scene_data scene, work *done)
{
  shadow_ray q;
  q.r = lifted_ray(s, scene);
  connection c = geodesic_to_light(q.r.p, light, k);
  done->light_solves += SELECT(a->lit, REAL(1), REAL(0));
  q.r.active = a->lit & NOT(c.exists & c.unsolved);
  q.r.v = push(q.r.p, select_3(c.exists, c.u, a->from));
  q.length = SELECT(c.exists, c.length, a->length);
  // As in point.h.
  a->intensity = SELECT(c.exists & c.unsolved, REAL(NAN), a->intensity);
  return q;
}
