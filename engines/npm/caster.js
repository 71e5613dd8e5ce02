// A field of inside fractions of a mesh, from which SweptShadow makes its shadow. Ways along z through a part of each cell collect where
// they enter and leave the mesh; inside is where the winding number is not 0.

const PLACES = 3;  // ways to a side of a cell

/**
 * @param {ArrayLike<number>} positions three numbers per vertex @param {ArrayLike<number>} triangles three vertices each
 * @param {number} [cells_across] along the longest side
 */
export function casterOf(positions, triangles, cells_across = 16) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < triangles.length; ++i)
    for (let axis = 0; axis < 3; ++axis) {
      const x = positions[3 * triangles[i] + axis];
      low[axis] = Math.min(low[axis], x);
      high[axis] = Math.max(high[axis], x);
    }
  const cell_size = Math.max(...high.map((x, axis) => x - low[axis])) / cells_across, middle = high.map((x, axis) => (x + low[axis]) / 2);
  const cells = /** @type {[number, number, number]} */ (high.map((x, axis) => Math.max(1, Math.ceil((x - low[axis]) / cell_size)) + 1));
  const origin = /** @type {[number, number, number]} */ (middle.map((x, axis) => x - (cells[axis] - 1) / 2 * cell_size));
  const sums = new Float64Array(cells[0] * cells[1] * cells[2]);
  for (const [way, crossings] of crossingsOf(positions, triangles, origin, cell_size, cells)) {
    const x = Math.floor(way % (PLACES * cells[0]) / PLACES), y = Math.floor(Math.floor(way / (PLACES * cells[0])) / PLACES);
    crossings.sort((a, b) => a.at - b.at);
    for (let i = 0, winding = 0; i + 1 < crossings.length; ++i) {
      winding += crossings[i].sign;
      if (winding === 0) continue;
      for (let z = Math.max(0, Math.floor(crossings[i].at)); z < Math.min(cells[2], crossings[i + 1].at); ++z)
        sums[(z * cells[1] + y) * cells[0] + x] += Math.min(z + 1, crossings[i + 1].at) - Math.max(z, crossings[i].at);
    }
  }
  return { origin, cell_size, cells, fractions: Uint8Array.from(sums, sum => Math.round(255 * sum / PLACES ** 2)) };
}

// Where ways meet triangles, in cells from the first cell's end, by the number of the way.
function crossingsOf(positions, triangles, origin, cell_size, cells) {
  const found = new Map(), columns = PLACES * cells[0], rows = PLACES * cells[1];
  const placeOf = vertex => [0, 1, 2].map(axis =>
    ((positions[3 * vertex + axis] - origin[axis]) / cell_size + 0.5) * (axis < 2 ? PLACES : 1));
  // A way through an edge is a hair beside it, on the same side for both triangles.
  const [shift_x, shift_y] = [0.5 + 1.23e-7, 0.5 + 2.71e-7];
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = [0, 1, 2].map(corner => placeOf(triangles[t + corner]));
    const area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    if (area === 0) continue;
    const [x0, x1] = [Math.min(a[0], b[0], c[0]), Math.max(a[0], b[0], c[0])];
    const [y0, y1] = [Math.min(a[1], b[1], c[1]), Math.max(a[1], b[1], c[1])];
    for (let j = Math.max(0, Math.floor(y0 - 1)); j < Math.min(rows, y1); ++j)
      for (let i = Math.max(0, Math.floor(x0 - 1)); i < Math.min(columns, x1); ++i) {
        const x = i + shift_x, y = j + shift_y;
        const p = ((b[0] - x) * (c[1] - y) - (b[1] - y) * (c[0] - x)) / area;
        const q = ((c[0] - x) * (a[1] - y) - (c[1] - y) * (a[0] - x)) / area;
        if (p < 0 || q < 0 || p + q > 1) continue;
        const way = j * columns + i, crossing = { at: p * a[2] + q * b[2] + (1 - p - q) * c[2], sign: area < 0 ? 1 : -1 };
        if (found.has(way)) found.get(way).push(crossing);
        else found.set(way, [crossing]);
      }
  }
  return found;
}
