// cells.h - which cell of the tiling a ray is in: a table gives, for each cell and wall, the cell behind it. WALLS and CELLS
// are its size; the number CELLS stands for every cell beyond the table, and is never left again.
FN real cell_behind(real cell, mask crossing, int wall, scene_data scene)
{
  if (!ANY(crossing)) return cell;
  real_lanes cells = {cell};
  mask_lanes crosses = {crossing};
  for (int lane = 0; lane < LANES; lane++)
    if (crosses.at[lane] && cells.at[lane] < CELLS) cells.at[lane] = scene.next_cell[(int)cells.at[lane] * WALLS + wall];
  return cells.lanes;
}
