// shadow_ray.h - the ray from just above a surface to a light (shadow_to_light.h, shadow_to_sun.h), whose shadow is cast by
// hard_shadow.h or soft_shadow.h.
typedef struct { ray r; real length; } shadow_ray;
