// within.h - light along all geodesics that are no longer than a length: they come shortest first, so that a lane is done with the first
// that is longer, or unsolved: that has to arrive, so that its pixel is counted.
FN mask arrives_within(arrival a, real most) { return NOT(a.length > most) | NOT(a.intensity == a.intensity); }
// Whether a longer one is looked for.
FN mask goes_on(arrival a, real most) { return a.length <= most; }
