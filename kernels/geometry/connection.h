// connection.h - what every geometry says of a geodesic between two points: connect_points(p, q, p_tail, q_tail, k) gives the
// k-th, shortest first. Tails are the low parts of p and q in single precision, zero where there are none.
typedef struct {
  direction u;  // at p, in the frame there
  real length;
  mask exists;
  mask family;    // one of a circle or sphere of geodesics, equally long, between these points
  mask unsolved;  // a solver reached its bound of iterations
} connection;
