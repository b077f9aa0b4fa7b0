// fog_linear.h - the fraction of light that is left after a length in fog that takes the same amount on every unit, until nothing is
// left (paper eq. 5.5). Number: the length at which nothing is.
FN real fog_linear(real length, scene_data scene, int k) { return REAL(1) - fmin(length / number(scene, k), REAL(1)); }
