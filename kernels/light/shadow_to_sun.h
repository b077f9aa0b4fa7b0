// shadow_to_sun.h - the ray to the sun, as far as rays go.
FN shadow_ray towards_sun(shading s, arrival *a, scene_data scene)
{
  shadow_ray q = {lifted_ray(s, scene), number(scene, FAR)};
  q.r.active = a->lit;
  q.r.v = push(q.r.p, a->from);
  return q;
}
