// falloff_constant.h - light does not fade (paper 5.9).
FN real falloff_constant(arrival a) { return a.intensity; }
