// numerics.cl - the geometry contract over arrays (arrays.h), for the Python API; the flow is flow.cl. One kernel a function.
//
// Points have 4 components, directions 3.

// base 0-3, direction 4-6, time 7, time_tail 8 -> the matrix of parallel transport between the frames, row by row 0-8
__kernel void numerics_transport(ARRAYS)
{
  point base = get_4(0, in, stride);
  direction u = get_3(4, in, stride), arriving = u;
  real t = component(7, in, stride), tail = component(8, in, stride);
  point reached = exponential(&arriving, t, tail);
  for (int k = 0; k < 3; k++) {
    direction e = {REAL(k == 0), REAL(k == 1), REAL(k == 2)};
    direction column = turn_frame(base, reached, transport(u, t, tail, e));
    put(column.x, k, out, stride);
    put(column.y, 3 + k, out, stride);
    put(column.z, 6 + k, out, stride);
  }
}

// point 0-3, direction 4-6 -> ambient velocity 0-3
__kernel void numerics_velocity(ARRAYS) { put_4(velocity(get_4(0, in, stride), get_3(4, in, stride)), 0, out, stride); }

// base 0-3, point 4-7, base_tail 8-11, point_tail 12-15 -> distance 0, reached the bound of iterations 1
__kernel void numerics_distance(ARRAYS)
{
  mask unsolved;
  put(distance_between(get_4(0, in, stride), get_4(4, in, stride), get_4(8, in, stride), get_4(12, in, stride), &unsolved), 0,
      out, stride);
  put_mask(unsolved, 1, out, stride);
}

// point 0-3 -> lower bound of the distance from the origin 0
__kernel void numerics_underestimate(ARRAYS) { put(underestimate(get_4(0, in, stride)), 0, out, stride); }

// base 0-3, point 4-7, base_tail 8-11, point_tail 12-15; the k-th -> direction 0-2, length 3; NaN where there is none; reached
// the bound of iterations 4; one of a family 5
__kernel void numerics_geodesic(ARRAYS, int k)
{
  connection found = connect_points(get_4(0, in, stride), get_4(4, in, stride), get_4(8, in, stride), get_4(12, in, stride), k);
  real absent = SELECT(found.exists, REAL(0), REAL(NAN));
  put(found.u.x + absent, 0, out, stride);
  put(found.u.y + absent, 1, out, stride);
  put(found.u.z + absent, 2, out, stride);
  put(found.length + absent, 3, out, stride);
  put_mask(found.unsolved, 4, out, stride);
  put_mask(found.exists & found.family, 5, out, stride);
}

// direction 0-2, time 3, time_tail 4 -> area density 0
__kernel void numerics_area_density(ARRAYS)
{
  put(area_density(get_3(0, in, stride), component(3, in, stride), component(4, in, stride)), 0, out, stride);
}

// base 0-3, point 4-7 -> point 0-3
__kernel void numerics_translate(ARRAYS) { put_4(on_model(translate(get_4(0, in, stride), get_4(4, in, stride))), 0, out, stride); }
__kernel void numerics_untranslate(ARRAYS) { put_4(on_model(untranslate(get_4(0, in, stride), get_4(4, in, stride))), 0, out, stride); }
