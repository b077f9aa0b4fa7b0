// cells.h - which cell of the tiling a ray is in: a table gives, for each cell and wall, the cell behind it. WALLS and CELLS
// are its size; the number CELLS stands for every cell beyond the table, and is never left again.

// Behind the same wall so many times in each lane, and where that is not above 0 none.
FN real cell_behind_all(real cell, real crossings, int wall, scene_data scene)
{
  if (!ANY(crossings > REAL(0))) return cell;
  real_lanes cells = {cell}, left = {crossings};
  for (int lane = 0; lane < LANES; lane++)
    for (; left.at[lane] > 0 && cells.at[lane] < CELLS; left.at[lane] -= 1)
      cells.at[lane] = scene.next_cell[(int)cells.at[lane] * WALLS + wall];
  return cells.lanes;
}

FN real cell_behind(real cell, mask crossing, int wall, scene_data scene)
{
  return cell_behind_all(cell, SELECT(crossing, REAL(1), REAL(0)), wall, scene);
}

// Where light number `light` of those that are not repeated stands, seen from the cells of the lanes; *known where the table
// has them.
FN point seen_from_cell(real cell, int light, mask *known, scene_data scene)
{
  real_lanes cells = {cell}, place[4];
  for (int lane = 0; lane < LANES; lane++) {
    int k = cells.at[lane] < CELLS ? (int)cells.at[lane] : 0;
    for (int c = 0; c < 4; c++) place[c].at[lane] = scene.seen_from[4 * (light * CELLS + k) + c];
  }
  *known = cell < REAL(CELLS);
  point p = {place[0].lanes, place[1].lanes, place[2].lanes, place[3].lanes};
  return p;
}
