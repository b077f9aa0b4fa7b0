// fog.h - what is seen through fog (paper eq. 5.6): the color, of whose light a fraction is left, and for the rest the fog.
FN real3_lanes in_fog(real3_lanes seen, real left, real3_lanes fog) { return add_scaled_3(scale_3(seen, left), fog, REAL(1) - left); }
