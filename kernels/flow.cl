// flow.cl - the flow that rays are marched along, over arrays (arrays.h), for the Python API.

// base 0-3, direction 4-6, time 7, time_tail 8 -> point 0-3, direction 4-6
__kernel void numerics_flow(ARRAYS)
{
  point base = get_4(0, in, stride);
  direction u = get_3(4, in, stride);
  point reached = flow_from_origin(&u, component(7, in, stride), component(8, in, stride));
  put_4(on_model(translate(base, reached)), 0, out, stride);
  direction arriving = turn_frame(base, reached, u);
  put_3(scale_3(arriving, unit_correction(dot_3(arriving, arriving))), 4, out, stride);
}
