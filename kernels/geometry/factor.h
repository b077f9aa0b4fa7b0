// factor.h - puts s3.h or h3.h with isotropic.h at the service of product.h: the names that both define get a prefix.
//
// S2 is the sphere z = 0 of S3, H2 the plane z = 0 of H3, and both are totally geodesic: every formula of constant curvature
// that a product needs stands in those files already. Paste this file before them; product.h takes the prefix off again.
#define origin factor_origin
#define inner factor_inner
#define flow factor_flow
#define push factor_push
#define pull factor_pull
#define pull_covector factor_pull_covector
#define velocity factor_velocity
#define gradient_of factor_gradient_of
#define translate factor_translate
#define untranslate factor_untranslate
#define turn_frame factor_turn_frame
#define exponential factor_exponential
#define origin_distance factor_origin_distance
#define distance_between factor_distance_between
#define connect_points factor_connect_points
#define area_density factor_area_density
#define underestimate factor_underestimate
#define overestimate factor_overestimate
#define coordinate_size factor_coordinate_size
#define wall_velocity factor_wall_velocity
#define wall_ratio factor_wall_ratio
#define crossing_time factor_crossing_time
#define reproject factor_reproject
#define on_model factor_on_model
