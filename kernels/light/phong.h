// phong.h - Phong's reflection model (paper 5.1, eq. 5.2), in the frame at the surface point.
typedef struct {
  point p;          // the surface point
  real cell;        // the cell it is seen in
  real way;         // the length of the way from the eye to it
  real object;      // the number of the object it belongs to
  direction normal; // unit, outwards
  direction viewer; // unit, where the ray came from
  material m;
} shading;

// Light that arrives: where from, how far it came, how strong, and in which lanes it counts.
typedef struct { direction from; real length, intensity; mask lit; } arrival;

FN real3_lanes phong_ambient(shading s) { return scale_3(s.m.color, s.m.ambient); }

FN real3_lanes phong(shading s, arrival a, real3_lanes light_color)
{
  // Light that does not count may come from nowhere.
  a.from = select_3(a.lit, a.from, s.normal);
  real facing = dot_3(s.normal, a.from);
  direction mirrored = add_scaled_3(scale_3(s.normal, REAL(2) * facing), a.from, REAL(-1));
  real glance = dot_3(mirrored, s.viewer);
  mask shines = glance > REAL(0);
  real lobe = SELECT(shines, exp(s.m.shininess * log(SELECT(shines, glance, REAL(1)))), REAL(0));
  real strength = SELECT(a.lit, a.intensity, REAL(0));
  real diffuse = s.m.diffuse * facing * strength, specular = s.m.specular * lobe * strength;
  real3_lanes seen = {fma(diffuse, s.m.color.x, specular) * light_color.x, fma(diffuse, s.m.color.y, specular) * light_color.y,
                      fma(diffuse, s.m.color.z, specular) * light_color.z};
  return seen;
}
