// within.h - light along all geodesics that are no longer than a length: they come shortest first, so that one that is longer in
// all lanes ends the search.
FN mask arrives_within(arrival a, real most) { return NOT(a.length > most); }
