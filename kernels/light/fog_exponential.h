// fog_exponential.h - the fraction of light that is left after a length in fog, by the Beer-Lambert law (paper eq. 5.5). Number:
// density.
FN real fog_exponential(real length, scene_data scene, int k) { return exp(-number(scene, k) * length); }
