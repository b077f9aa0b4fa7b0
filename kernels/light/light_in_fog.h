// light_in_fog.h - fog dims light on its way from a lamp to the surface too (paper 5.3).
FN real scene_clear(real length, scene_data scene);
FN real light_in_fog(arrival a, scene_data scene) { return a.intensity * scene_clear(a.length, scene); }
