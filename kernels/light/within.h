// within.h - light along all geodesics that are no longer than a length: they come shortest first, so that a lane is done with the first
// that is longer.
FN mask arrives_within(arrival a, real most) { return a.length <= most; }
