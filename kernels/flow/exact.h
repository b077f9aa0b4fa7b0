// exact.h - the flow that rays are marched along, by the closed form of the geometry.
FN point flow_from_origin(direction *u, real t, real tail) { return exponential(u, t, tail); }
FN void ray_flow(point *p, vector *v, real t) { flow(p, v, t); }
