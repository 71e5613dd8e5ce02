// How many clouds shade each other and the ground at once: preview/mesh_clouds/shade_grid.h. What the graphics card reads of it are two
// textures: the shares of the light past all clouds, and for each cloud those past all others, at the nodes around it.

const clamp = (x, low, high) => Math.min(high, Math.max(low, x));

const CELLS = 384, SLICES = 16, CELLS_PER_CLOUD = 16, MARGIN = 1.5, PER_DEPTH = 4096, LEAST = 1e-6, LEAST_ALONG = 0.02;

// Turns a vector about y.
const turned = ([x, y, z], cosine, sine) => [cosine * x + sine * z, y, cosine * z - sine * x];

// The box of a frame along an axis: across it, sheared along the light, and along it.
function shearedBox(low, high, light, axis) {
  const across = (axis + 1) % 3, aside = (axis + 2) % 3, slopes = [light[across] / light[axis], light[aside] / light[axis]];
  const box = { axis, across, aside, slopes, low: [Infinity, Infinity, Infinity], high: [-Infinity, -Infinity, -Infinity] };
  for (let corner = 0; corner < 8; ++corner) {
    const p = [0, 1, 2].map(i => (corner >> i & 1 ? high : low)[i]);
    [p[across] - slopes[0] * p[axis], p[aside] - slopes[1] * p[axis], p[axis]].forEach((at, side) => {
      box.low[side] = Math.min(box.low[side], at);
      box.high[side] = Math.max(box.high[side], at);
    });
  }
  return box;
}

/** @typedef {number[]} Vec3 */
/** @typedef {{ rows: number[][], nodes: number[], axis: number }} ShadeFrame where the nodes of a grid are */

/**
 * The frame in which a box of the world fits: rows that take a point of the world, with 1 as fourth, to coordinates of nodes.
 * @param {{ low: Vec3, high: Vec3, cloud_size: number }} extent @param {Vec3} light @param {Vec3} wind @returns {ShadeFrame}
 */
export function shadeFrame({ low, high, cloud_size }, light, wind) {
  const volume = box => box.high.reduce((product, x, side) => product * (x - box.low[side]), 1);
  const box = [0, 1, 2].filter(axis => Math.abs(light[axis]) > LEAST_ALONG).map(axis => shearedBox(low, high, light, axis))
    .reduce((a, b) => volume(b) < volume(a) ? b : a);
  const sizes = box.high.map((x, side) => x - box.low[side]), smallest = cloud_size / CELLS_PER_CLOUD, { axis } = box;
  const cell = Math.max(Math.max(sizes[0], sizes[1]) / (CELLS - 2 * MARGIN - 2), smallest);
  const height = Math.max(sizes[2] / (SLICES - 3), smallest), rows = [0, 1, 2].map(() => [0, 0, 0, 0]), nodes = [0, 0, 0];
  [box.across, box.aside].forEach((own, side) => {
    const drift = wind[own] - box.slopes[side] * wind[axis], first = Math.floor((box.low[side] - drift) / cell - MARGIN);
    rows[side][own] = 1 / cell;
    rows[side][axis] = -box.slopes[side] / cell;
    rows[side][3] = -first - drift / cell;
    nodes[side] = Math.ceil(sizes[side] / cell + 2 * MARGIN) + 2;
  });
  rows[2][axis] = (light[axis] > 0 ? -1 : 1) / height;
  rows[2][3] = 1 + (light[axis] > 0 ? box.high[2] : -box.low[2]) / height;
  nodes[2] = Math.ceil(sizes[2] / height) + 3;
  return { rows, nodes, axis };
}

/**
 * A cloud of a grid: the shadow of its mesh, in a space that is made larger, turned about y and moved to the world; its light is turned
 * with it. `power`: of what it lets through.
 * @typedef {object} ShadeCloud
 * @property {import('./swept_shadow.js').SweptShadow} shadow
 * @property {Vec3} at @property {number} scale @property {number} cosine @property {number} sine @property {number} power
 */

// A point of the world in the space of a cloud's shadow, and back.
const toShadow = ({ at, scale, cosine, sine }, point) => turned(point.map((x, i) => (x - at[i]) / scale), cosine, -sine);
const toWorld = ({ at, scale, cosine, sine }, point) => turned(point, cosine, sine).map((x, i) => at[i] + scale * x);

export class ShadeGrid {
  /** @param {ShadeFrame} frame @param {ShadeCloud[]} clouds @param {Vec3} light */
  constructor(frame, clouds, light) {
    this.frame = frame;
    this.light = light;
    const [width, height, depth] = frame.nodes;
    this.steps = new Int32Array(width * height * depth);
    this.columns = clouds.map(cloud => this.columnsOf(cloud));
    for (const columns of this.columns) this.add(columns);
    const slice = width * height;
    for (let at = slice; at < this.steps.length; ++at) this.steps[at] += this.steps[at - slice];
  }

  /** @returns {Vec3} */
  place(point) {
    return /** @type {Vec3} */ (this.frame.rows.map(([x, y, z, one]) => x * point[0] + y * point[1] + z * point[2] + one));
  }

  // The nodes that something between two coordinates of the grid may reach.
  nodesAround(low, high) {
    const { nodes } = this.frame, within = (x, side) => clamp(x, 0, nodes[side] - 1);
    const more = [0.5, 0.5, 0], first = low.map((x, side) => within(Math.floor(x - more[side]), side));
    return { first, count: high.map((x, side) => within(Math.ceil(x + more[side]), side) - first[side] + 1) };
  }

  // The nodes around points of the world.
  nodesOf(points) {
    const places = points.map(point => this.place(point));
    const ends = /** @type {const} */ (['min', 'max']).map(end => [0, 1, 2].map(side => Math[end](...places.map(place => place[side]))));
    return this.nodesAround(ends[0], ends[1]);
  }

  // The optical depth of a cloud in the columns of the nodes around it, and between which coordinates it is added: linear in their numbers.
  columnsOf(cloud) {
    const { shadow, scale, power } = cloud, { rows, axis } = this.frame;
    const { first, count } = this.nodesOf(shadow.corners().map(corner => toWorld(cloud, corner)));
    const across = (axis + 1) % 3, aside = (axis + 2) % 3, per_way = rows[2][axis] * this.light[axis] * scale;
    const meets = (i, j) => {
      const point = [0, 0, 0];
      point[across] = (first[0] + i - rows[0][3]) / rows[0][across];
      point[aside] = (first[1] + j - rows[1][3]) / rows[1][aside];
      const { u, v, enters, leaves } = shadow.wayThrough(toShadow(cloud, point));
      return [u, v, rows[2][3] + per_way * enters, rows[2][3] + per_way * leaves];
    };
    const zero = meets(0, 0), one = meets(1, 0).map((x, i) => x - zero[i]), other = meets(0, 1).map((x, i) => x - zero[i]);
    const depths = new Float64Array(count[0] * count[1]);
    shadow.absorbedOver(zero, one, other, count, (column, absorbed) => {
      depths[column] = -Math.log(clamp(1 - absorbed, LEAST, 1)) * power;
    });
    const line = i => [zero[i], one[i], other[i]];
    return { first, count, depths, enters: line(2), leaves: line(3) };
  }

  // Adds the changes from slice to slice.
  add({ first, count, depths, enters, leaves }) {
    const { steps, frame: { nodes: [width, height, depth] } } = this, slice = width * height;
    for (let j = 0, column = 0; j < count[1]; ++j)
      for (let i = 0; i < count[0]; ++i, ++column) {
        if (!(depths[column] > 0)) continue;
        const all = depths[column] * PER_DEPTH, begin = enters[0] + i * enters[1] + j * enters[2];
        const long = leaves[0] + i * leaves[1] + j * leaves[2] - begin;
        const most = Math.floor(all * clamp((depth - 1 - begin) / long, 0, 1) + 0.5);
        let z = clamp(Math.floor(begin), 0, depth - 1), at = z * slice + (first[1] + j) * width + first[0] + i;
        for (let before = 0; z < depth && before < most; ++z, at += slice) {
          const now = Math.floor(all * clamp((z - begin) / long, 0, 1) + 0.5);
          steps[at] += now - before;
          before = now;
        }
      }
  }

  /**
   * The shares of the light at the nodes `around`, past all clouds but one.
   * @param {{ first: number[], count: number[] }} around @param {number} [own] the number of that cloud
   */
  sharesAround({ first, count }, own) {
    const { steps, columns: { [own ?? -1]: columns }, frame: { nodes: [width, height] } } = this;
    const shares = new Float32Array(count[0] * count[1] * count[2]);
    for (let k = 0, node = 0; k < count[2]; ++k)
      for (let j = 0; j < count[1]; ++j)
        for (let i = 0, at = ((first[2] + k) * height + first[1] + j) * width + first[0]; i < count[0]; ++i, ++node, ++at) {
          let depth = steps[at];
          if (depth && columns) {
            const { depths, enters, leaves } = columns, begin = enters[0] + i * enters[1] + j * enters[2];
            const long = leaves[0] + i * leaves[1] + j * leaves[2] - begin;
            depth -= Math.floor(depths[j * count[0] + i] * PER_DEPTH * clamp((first[2] + k - begin) / long, 0, 1) + 0.5);
          }
          shares[node] = depth ? Math.exp(-depth / PER_DEPTH) : 1;
        }
    return shares;
  }

  /** @param {number} own the number of a cloud; its block. */
  pastOthers(own) {
    const { first, count } = this.columns[own];
    return { first, count, shares: this.sharesAround({ first, count }, own) };
  }

  get pastAll() {
    const around = { first: [0, 0, 0], count: this.frame.nodes };
    return { ...around, shares: this.sharesAround(around) };
  }

  // Multiplies the shares of points of the world, three numbers each, by those between the nodes of a block.
  multiply({ first, count, shares: nodes }, points, begin, number, shares) {
    const { rows } = this.frame, last = [0, 1, 2].map(side => Math.max(0, count[side] - 2)), low = [0, 0, 0], part = [0, 0, 0];
    const [dx, dy, dz] = [1, count[0], count[0] * count[1]].map((size, side) => count[side] > 1 ? size : 0);
    for (let i = begin; i < begin + number; ++i) {
      const x = points[3 * i], y = points[3 * i + 1], z = points[3 * i + 2];
      for (let side = 0; side < 3; ++side) {
        const row = rows[side], at = clamp(row[0] * x + row[1] * y + row[2] * z + row[3] - first[side], 0, count[side] - 1);
        low[side] = Math.min(Math.floor(at), last[side]);
        part[side] = at - low[side];
      }
      const at = (low[2] * count[1] + low[1]) * count[0] + low[0], [px, py, pz] = part;
      const row = n => nodes[n] + px * (nodes[n + dx] - nodes[n]);
      const near = row(at) + py * (row(at + dy) - row(at)), far = row(at + dz) + py * (row(at + dz + dy) - row(at + dz));
      shares[i] *= near + pz * (far - near);
    }
  }

  /**
   * The blocks of clouds beside each other in one texture: its size, its numbers, and for each cloud what takes a place of the grid to the
   * texture's.
   * @param {{ first: number[], count: number[], own?: number }[]} blocks
   */
  packed(blocks) {
    const order = blocks.map((_, i) => i).sort((a, b) => blocks[b].count[1] - blocks[a].count[1] || a - b);
    const area = blocks.reduce((sum, { count }) => sum + count[0] * count[1], 0);
    const depth = Math.max(1, ...blocks.map(({ count }) => count[2]));
    const width = Math.max(16, ...blocks.map(({ count }) => count[0]), Math.ceil(Math.sqrt(area * 1.2)));
    const corners = [];
    let x = 0, y = 0, row = 0;
    for (const i of order) {
      const [across, aside] = blocks[i].count;
      if (x + across > width) {
        x = 0;
        y += row;
        row = 0;
      }
      corners[i] = [x, y];
      x += across;
      row = Math.max(row, aside);
    }
    const height = Math.max(1, y + row), numbers = new Float32Array(width * height * depth), shifts = new Float32Array(3 * blocks.length);
    for (const [i, { first, count, own }] of blocks.entries()) {
      const shares = this.sharesAround({ first, count }, own), [left, bottom] = corners[i];
      for (let k = 0; k < count[2]; ++k)
        for (let j = 0; j < count[1]; ++j) {
          const begin = (k * count[1] + j) * count[0];
          numbers.set(shares.subarray(begin, begin + count[0]), (k * height + bottom + j) * width + left);
        }
      shifts.set([left - first[0], bottom - first[1], -first[2]], 3 * i);
    }
    return { size: [width, height, depth], numbers, shifts };
  }
}
