// The volume inside a closed mesh, which truth and volume are marched through: the share of each cell that is inside, as in
// bake/field/coverage.h, and how much cloud is between its centre and the light, as in bake/lobe/sweep.h.

import { tell } from './dom.js';
import { InsideLengths, twiceArea } from './lengths.js';
import { volumeRefusal } from './state.js';

const CELLS = 200;         // along the longest side
const STEPS = 200;         // of a march along it
const HEIGHT_STEPS = 4096; // of a cell: sums of them are exact in floats, so that empty cells are 0

export class VolumeField {
  /** @param {InsideLengths} inside */
  constructor(inside, cells_along = CELLS) {
    const { positions, corners, part: { first_vertex } } = inside, low = [Infinity, Infinity, Infinity], high = low.map(x => -x);
    const axes = [0, 1, 2].map(axis => {
      const along = new Float64Array(inside.welded.length);
      for (let v = 0; v < along.length; ++v) along[v] = positions[3 * (first_vertex + v) + axis];
      for (const v of corners) {
        low[axis] = Math.min(low[axis], along[v]);
        high[axis] = Math.max(high[axis], along[v]);
      }
      return along;
    });
    this.cell_size = Math.max(...high.map((x, axis) => x - low[axis])) / cells_along;
    const middle = [0, 1, 2].map(axis => (low[axis] + high[axis]) / 2), half = middle.map((x, axis) =>
      Math.ceil((x - low[axis]) / this.cell_size) + 2);
    this.cells = half.map(x => 2 * x + 1);
    this.origin = middle.map((x, axis) => x - half[axis] * this.cell_size);
    this.steps = [1, this.cells[0], this.cells[0] * this.cells[1]];
    axes.forEach((along, axis) => along.forEach((x, v) => { along[v] = (x - this.origin[axis]) / this.cell_size; }));
    this.fractions = new Float32Array(this.steps[2] * this.cells[2]);
    for (let axis = 0; axis < 3; ++axis) this.addLines(axes, corners, axis);
    this.fractions.forEach((sum, i) => { this.fractions[i] = sum / 3; });
    this.measure();
  }

  // Adds the inside shares of the lines through the cells' centres along an axis.
  addLines(axes, corners, axis) {
    const { cells, steps, fractions } = this, across = (axis + 1) % 3, aside = (axis + 2) % 3, step = steps[axis];
    const changes = new Float32Array(fractions.length);
    const change = (first, z, amount) => {
      const cell = Math.floor(z + 0.5), share = Math.round((cell + 0.5 - z) * HEIGHT_STEPS) / HEIGHT_STEPS, at = first + cell * step;
      changes[at] += amount * share;
      changes[at + step] += amount * (1 - share);
    };
    crossingsOf(axes[across], axes[aside], axes[axis], corners, cells[across]).forEach((crossings, line) => {
      const first = line % cells[across] * steps[across] + Math.floor(line / cells[across]) * steps[aside];
      let winding = 0;
      crossings.sort((one, other) => one[0] - other[0]);
      for (const [z, sign] of crossings) {
        if (winding === 0) change(first, z, 1);
        winding += sign;
        if (winding === 0) change(first, z, -1);
      }
    });
    for (let i = 0; i < fractions.length; ++i) {
      if (Math.floor(i / step) % cells[axis]) changes[i] += changes[i - step];
      fractions[i] += changes[i];
    }
  }

  // The box outside which a trilinear read of the fractions gives 0, and the longest side of the cells with cloud.
  measure() {
    const { cells, steps, fractions } = this, low = [...cells], high = [0, 0, 0];
    fractions.forEach((fraction, i) => {
      if (!fraction) return;
      for (let axis = 0; axis < 3; ++axis) {
        const at = Math.floor(i / steps[axis]) % cells[axis];
        low[axis] = Math.min(low[axis], at);
        high[axis] = Math.max(high[axis], at);
      }
    });
    this.longest_side = Math.max(...high.map((x, axis) => x - low[axis])) + 1;
    this.extent = [low.map(x => x - 1), high.map(x => x + 1)];
  }

  // ℓ from each cell's centre along a unit direction, in cells. With u = a - slope * c, a line along the direction is a place of a plane:
  // what is behind it there is summed from slice to slice, beginning at the light.
  lengthsTowards(direction) {
    const { cells, steps, fractions } = this, sizes = direction.map(Math.abs), axis = sizes.indexOf(Math.max(...sizes));
    const [across, aside] = [(axis + 1) % 3, (axis + 2) % 3], [m, n] = [cells[across], cells[aside]];
    const [u_slope, v_slope] = [across, aside].map(other => direction[other] / direction[axis]), slices = cells[axis];
    const left = Math.floor(Math.min(0, -u_slope * (slices - 1))) - 2, bottom = Math.floor(Math.min(0, -v_slope * (slices - 1))) - 2;
    const width = Math.ceil(m + Math.max(0, -u_slope * (slices - 1))) + 3 - left;
    const height = Math.ceil(n + Math.max(0, -v_slope * (slices - 1))) + 3 - bottom;
    const sums = new Float64Array(width * height), lengths = new Float32Array(fractions.length);
    const [du, dv] = [steps[across], steps[aside]];
    for (let slice = 0; slice < slices; ++slice) {
      const k = direction[axis] > 0 ? slices - 1 - slice : slice, first = k * steps[axis];
      const b = Math.floor(u_slope * k), c = Math.floor(v_slope * k), p = u_slope * k - b, q = v_slope * k - c;
      // Half of the slice counts for its own cells. The field has margins without cloud.
      const addHalf = () => {
        for (let j = 0; j < n - 1; ++j)
          for (let i = 0, at = first + j * dv, to = (j - c - bottom) * width - b - left; i < m - 1; ++i, at += du)
            sums[to + i] += 0.5 * ((1 - q) * ((1 - p) * fractions[at] + p * fractions[at + du])
              + q * ((1 - p) * fractions[at + dv] + p * fractions[at + dv + du]));
      };
      addHalf();
      for (let j = 0; j < n; ++j)
        for (let i = 0; i < m; ++i) {
          const here = (j - c - bottom) * width + i - b - left;
          lengths[first + i * du + j * dv] = ((1 - q) * ((1 - p) * sums[here] + p * sums[here - 1])
            + q * ((1 - p) * sums[here - width] + p * sums[here - width - 1])) / sizes[axis];
        }
      addHalf();
    }
    return lengths;
  }

  // The corners of the extent in the world.
  corners() {
    return Array.from({ length: 8 }, (_, i) => [0, 1, 2].map(k => this.origin[k] + this.cell_size * this.extent[i >> k & 1][k]));
  }
}

// Where a mesh crosses the lines x = i, y = j, by i + j * width: heights and senses.
function crossingsOf(x, y, z, corners, width) {
  const lines = [];
  for (let t = 0; t < corners.length; t += 3) {
    const [a, b, c] = [corners[t], corners[t + 1], corners[t + 2]];
    const last = Math.floor(Math.max(x[a], x[b], x[c])), top = Math.floor(Math.max(y[a], y[b], y[c]));
    for (let j = Math.ceil(Math.min(y[a], y[b], y[c])); j <= top; ++j)
      for (let i = Math.ceil(Math.min(x[a], x[b], x[c])); i <= last; ++i) {
        const wa = twiceArea(x, y, i, j, b, c), wb = twiceArea(x, y, i, j, c, a), wc = twiceArea(x, y, i, j, a, b), sum = wa + wb + wc;
        if (wa > 0 !== wb > 0 || wb > 0 !== wc > 0) continue;
        (lines[j * width + i] ??= []).push([(wa * z[a] + wb * z[b] + wc * z[c]) / sum, Math.sign(sum)]);
      }
  }
  return lines;
}

// What the march needs of a scene, on the graphics card.
export class Volume {
  /** @param {Viewer} viewer */
  constructor(viewer) {
    this.viewer = viewer;
    this.forget();
  }

  forget() { this.field = this.sunOfLengths = this.toSky = null; }

  // The lengths follow the sun once it rests.
  get isNeeded() {
    const { viewer: { state: { light, against, sun }, pointers } } = this;
    if (![light, against].some(name => name === 'truth' || name === 'volume') || this.sunOfLengths === String(sun)) return false;
    return !this.field || !pointers.size;
  }

  computeIfNeeded() {
    if (!this.isNeeded) return;
    const { viewer, viewer: { state, scene: { parts, arrays } } } = this, [part] = parts;
    if (!this.field) {
      const inside = new InsideLengths(arrays, part);
      part.is_open = !inside.isClosed;
      if (part.is_open) {
        tell(volumeRefusal(viewer.scene));
        viewer.change({});  // leaves out what needs a volume
        return;
      }
      this.field = new VolumeField(inside);
      this.toSky = this.field.lengthsTowards([0, 1, 0]);
    }
    this.sunOfLengths = String(state.sun);
    const { field: { cells, fractions } } = this, numbers = new Float32Array(4 * fractions.length);
    const to_sun = this.field.lengthsTowards(viewer.light.towardsLight([state.sun[0], state.sun[1]]));
    fractions.forEach((fraction, i) => numbers.set([fraction, to_sun[i], this.toSky[i]], 4 * i));
    viewer.renderer.gpu.uploadSpace('volume', cells, numbers);
  }

  // The uniforms of march.glsl, but for the direction to the light.
  values(density) {
    const { field: { origin, cell_size, extent: [extent_low, extent_high], longest_side }, viewer: { scene } } = this, [part] = scene.parts;
    const { view_extinction, asymmetry, octaves: [count, ...shares] } = part.volume, extinction = part.extinction * density * cell_size;
    return {
      volume: 'volume', volume_origin: origin, cell_size, extent_low, extent_high, volume_side: longest_side,
      extinctions: [extinction, view_extinction * extinction], march_steps: [STEPS, count], octaves: [...shares, asymmetry],
    };
  }
}
