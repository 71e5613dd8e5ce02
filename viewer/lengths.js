// Exact lengths inside a mesh: how much cloud lies between a vertex and a light, by the triangles themselves. Inside is where the winding
// number is not 0, as in bake/truth/reference.h.

import { clamp, cross, normalize } from './vectors.js';

// The same number for all vertices at one place, which UV seams split.
function weldVertices(positions) {
  const places = new Map(), welded = new Uint32Array(positions.length / 3);
  for (let v = 0; v < welded.length; ++v) {
    const key = `${positions[3 * v]} ${positions[3 * v + 1]} ${positions[3 * v + 2]}`;
    if (!places.has(key)) places.set(key, v);
    welded[v] = places.get(key);
  }
  return welded;
}

// Twice the area of a point and the edge from a to b. Two triangles at an edge get the same number, and the point is moved by an
// infinitesimal step where it is exactly on the edge, so that exactly one of them is met.
export function twiceArea(x, y, px, py, a, b) {
  const [c, d] = a < b ? [a, b] : [b, a];
  const twice = (x[c] - px) * (y[d] - py) - (x[d] - px) * (y[c] - py) || Math.sign(y[c] - y[d] || x[d] - x[c]) * Number.MIN_VALUE;
  return a < b ? twice : -twice;
}

export class InsideLengths {
  /**
   * `part` names its range of `positions` and `triangles`, which are those of all parts.
   * @param {Pick<Arrays, 'positions' | 'triangles'>} arrays
   * @param {Pick<Part, 'first' | 'count' | 'first_vertex' | 'vertices'>} part
   */
  constructor({ positions, triangles }, part) {
    this.positions = positions;
    this.part = part;
    this.welded = weldVertices(positions.subarray(3 * part.first_vertex, 3 * (part.first_vertex + part.vertices)));
    this.corners = triangles.slice(part.first, part.first + part.count).map(v => this.welded[v - part.first_vertex]);
  }

  // Whether every edge has a triangle on both sides.
  get isClosed() {
    const edges = new Map(), count = this.part.vertices;
    for (let t = 0; t < this.corners.length; t += 3)
      for (let i = 0; i < 3; ++i) {
        const a = this.corners[t + i], b = this.corners[t + (i + 1) % 3], key = Math.min(a, b) * count + Math.max(a, b);
        edges.set(key, (edges.get(key) ?? 0) + (a < b ? 1 : -1));
      }
    return [...edges.values()].every(sum => sum === 0);
  }

  // Coordinates of the vertices across and along a unit direction.
  project(direction) {
    const side = normalize(cross(direction, Math.abs(direction[1]) < 0.9 ? [0, 1, 0] : [1, 0, 0])), other = cross(direction, side);
    const { positions, part: { first_vertex: first, vertices } } = this;
    const [x, y, along] = [side, other, direction].map(axis => {
      const values = new Float64Array(vertices);
      for (let v = 0, p = 3 * first; v < vertices; ++v, p += 3)
        values[v] = axis[0] * positions[p] + axis[1] * positions[p + 1] + axis[2] * positions[p + 2];
      return values;
    });
    return { x, y, along };
  }

  // Lists of triangles by the cell of a square lattice across the direction.
  sort({ x, y }) {
    const { corners } = this, triangles = corners.length / 3, n = clamp(Math.round(Math.sqrt(triangles)), 1, 2048);
    const range = values => values.reduce(([low, high], value) => [Math.min(low, value), Math.max(high, value)], [Infinity, -Infinity]);
    const [left, right] = range(x), [bottom, top] = range(y);
    const column = value => clamp(Math.floor((value - left) / (right - left) * n), 0, n - 1) || 0;
    const row = value => clamp(Math.floor((value - bottom) / (top - bottom) * n), 0, n - 1) || 0;
    const forCells = visit => {
      for (let t = 0; t < triangles; ++t) {
        const [a, b, c] = [corners[3 * t], corners[3 * t + 1], corners[3 * t + 2]];
        const last = column(Math.max(x[a], x[b], x[c])), high = row(Math.max(y[a], y[b], y[c]));
        for (let j = row(Math.min(y[a], y[b], y[c])); j <= high; ++j)
          for (let i = column(Math.min(x[a], x[b], x[c])); i <= last; ++i) visit(j * n + i, t);
      }
    };
    const starts = new Uint32Array(n * n + 1);
    forCells(cell => ++starts[cell + 1]);
    for (let cell = 0; cell < n * n; ++cell) starts[cell + 1] += starts[cell];
    const places = starts.slice(), list = new Uint32Array(starts[n * n]);
    forCells((cell, t) => { list[places[cell]++] = t; });
    return v => {
      const cell = row(y[v]) * n + column(x[v]);
      return list.subarray(starts[cell], starts[cell + 1]);
    };
  }

  // ℓ from each of the part's vertices, or from those that are named, in world units.
  towards(direction, only = null) {
    const projected = this.project(direction), cellOf = this.sort(projected), { welded } = this;
    const lengths = new Float32Array(only ? only.length : this.part.vertices);
    for (let i = 0; i < lengths.length; ++i) lengths[i] = this.lengthFrom(welded[only ? only[i] : i], projected, cellOf);
    return lengths;
  }

  lengthFrom(v, { x, y, along }, cellOf) {
    const { corners } = this, px = x[v], py = y[v], from = along[v], crossings = [];
    for (const t of cellOf(v)) {
      const a = corners[3 * t], b = corners[3 * t + 1], c = corners[3 * t + 2];
      if (a === v || b === v || c === v) continue;  // it begins here
      const wa = twiceArea(x, y, px, py, b, c), wb = twiceArea(x, y, px, py, c, a), wc = twiceArea(x, y, px, py, a, b);
      if (wa > 0 !== wb > 0 || wb > 0 !== wc > 0) continue;
      const sum = wa + wb + wc, distance = (wa * along[a] + wb * along[b] + wc * along[c]) / sum - from;
      if (distance > 0) crossings.push([distance, sum > 0 ? 1 : -1]);
    }
    crossings.sort((one, other) => other[0] - one[0]);
    let winding = 0, length = 0;  // at the far end the winding number is 0
    crossings.forEach(([distance, sign], i) => {
      winding += sign;
      if (winding !== 0) length += distance - (i + 1 < crossings.length ? crossings[i + 1][0] : 0);
    });
    return length;
  }
}
