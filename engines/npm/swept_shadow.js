// The shadow of a cloud on others, from its field of inside fractions: preview/mesh_clouds/cloud_shadow.h.

/** @typedef {{ origin: number[], cell_size: number, cells: [number, number, number], fractions: Uint8Array }} Caster */

const clamp = (x, low, high) => Math.min(high, Math.max(low, x));

// Reads the fractions of a field by slices along an axis: the fraction at (k, b, c), 0 outside, and the first and the last slice with any.
function slicesOf({ cells, fractions }, axis, across, aside) {
  const steps = [1, cells[0], cells[0] * cells[1]];
  const cell = (k, b, c) => b < 0 || c < 0 || b >= cells[across] || c >= cells[aside] ? 0
    : fractions[k * steps[axis] + b * steps[across] + c * steps[aside]];
  const isEmpty = k => {
    for (let c = 0; c < cells[aside]; ++c) for (let b = 0; b < cells[across]; ++b) if (cell(k, b, c)) return false;
    return true;
  };
  let first = 0, last = cells[axis] - 1;
  while (first < last && isEmpty(first)) ++first;
  while (last > first && isEmpty(last)) --last;
  return { cell, first, last };
}

export class SweptShadow {
  // `caster`: the field of a cloud. `to_own`: from the world to its space, 3 × 3 by columns and the offset.
  constructor(caster, to_own, extinction, to_light, { strength, softness }) {
    const { origin, cell_size, cells } = caster;
    this.origin = origin;
    this.cell_size = cell_size;
    this.to_own = to_own;
    const own = this.vectorToOwn(to_light), sizes = own.map(Math.abs), axis = sizes.indexOf(Math.max(...sizes));
    this.axis = axis;
    this.across = (axis + 1) % 3;
    this.aside = (axis + 2) % 3;
    this.slopes = [own[this.across] / own[axis], own[this.aside] / own[axis]];
    const [u_far, v_far] = this.slopes.map(slope => -slope * (cells[axis] - 1));
    this.left = Math.floor(Math.min(0, u_far)) - 1;
    this.bottom = Math.floor(Math.min(0, v_far)) - 1;
    this.width = Math.ceil(cells[this.across] - 1 + Math.max(0, u_far)) + 2 - this.left;
    this.height = Math.ceil(cells[this.aside] - 1 + Math.max(0, v_far)) + 2 - this.bottom;
    const slices = slicesOf(caster, axis, this.across, this.aside);
    this.sums = this.sumsOf(slices, sum => strength * (1 - Math.exp(-extinction * sum / 255 * (cell_size / sizes[axis]))));
    this.cells = cells;
    this.towards = own[axis] / cell_size;
    this.spread = Math.tan(softness * Math.PI / 180) * Math.hypot(...own) / sizes[axis];
    this.is_above = own[axis] > 0;
    this.low = slices.first - 0.5;
    this.high = slices.last + 0.5;
  }

  // The darkness behind all slices, summed over columns and rows; it follows from the sum of the fractions along the light.
  sumsOf({ cell, first, last }, darkness) {
    const { left, bottom, width, height, slopes: [u_slope, v_slope] } = this, sums = new Float64Array((width + 1) * (height + 1));
    for (let j = 0; j < height; ++j)
      for (let i = 0; i < width; ++i) {
        let sum = 0;
        for (let k = first; k <= last; ++k) {
          const b = left + i + u_slope * k, c = bottom + j + v_slope * k, x = Math.floor(b), y = Math.floor(c), p = b - x, q = c - y;
          sum += (1 - q) * ((1 - p) * cell(k, x, y) + p * cell(k, x + 1, y))
            + q * ((1 - p) * cell(k, x, y + 1) + p * cell(k, x + 1, y + 1));
        }
        const at = j * (width + 1) + i, above = at + width + 1;
        sums[above + 1] = sums[at + 1] + sums[above] - sums[at] + darkness(sum);
      }
    return sums;
  }

  vectorToOwn(v) { return [0, 1, 2].map(r => this.to_own[r] * v[0] + this.to_own[3 + r] * v[1] + this.to_own[6 + r] * v[2]); }

  integralTo(u, v) {
    const { left, bottom, width, height, sums } = this, x = clamp(u - left + 0.5, 0, width), y = clamp(v - bottom + 0.5, 0, height);
    const x0 = Math.min(Math.floor(x), width - 1), y0 = Math.min(Math.floor(y), height - 1), p = x - x0, q = y - y0;
    const at = y0 * (width + 1) + x0, above = at + width + 1;
    return (1 - q) * ((1 - p) * sums[at] + p * sums[at + 1]) + q * ((1 - p) * sums[above] + p * sums[above + 1]);
  }

  shareAt(point) {
    const { to_own, origin, cell_size, low, high, slopes, spread, left, bottom, width, height } = this;
    const place = this.vectorToOwn(point).map((x, i) => (x + to_own[9 + i] - origin[i]) / cell_size), a = place[this.axis];
    const share = clamp((this.is_above ? high - a : a - low) / (high - low), 0, 1);
    if (!(share > 0)) return 1;
    const u = place[this.across] - slopes[0] * a, v = place[this.aside] - slopes[1] * a;
    const middle = this.is_above ? (Math.max(a, low) + high) / 2 : (Math.min(a, high) + low) / 2;
    const half = Math.max(0.5, spread * Math.abs(middle - a));
    if (u + half < left || v + half < bottom || u - half > left + width || v - half > bottom + height) return 1;
    const sum = this.integralTo(u + half, v + half) - this.integralTo(u - half, v + half)
      - this.integralTo(u + half, v - half) + this.integralTo(u - half, v - half);
    const passed = clamp(1 - sum / (4 * half * half), 0, 1);
    return share < 1 ? passed ** share : passed;
  }

  // Where the way of the light through a point meets the plane of the shadow, and how far from the point, towards the light, it enters the
  // heights of the cloud and leaves them.
  wayThrough(point) {
    const { to_own, origin, cell_size, slopes, high, low, is_above, towards } = this;
    const place = this.vectorToOwn(point).map((x, i) => (x + to_own[9 + i] - origin[i]) / cell_size), a = place[this.axis];
    return {
      u: place[this.across] - slopes[0] * a, v: place[this.aside] - slopes[1] * a,
      enters: ((is_above ? high : low) - a) / towards, leaves: ((is_above ? low : high) - a) / towards,
    };
  }

  // The mean of what the whole cloud absorbs of the light over rectangles of the plane, whose places are linear in two numbers: `zero` at
  // (0, 0), and what `one` and `other` add. Calls take(the number of the place, the mean) where it is not 0.
  absorbedOver(zero, one, other, [columns, rows], take) {
    const { left, bottom, width, height, sums } = this, stride = width + 1;
    const a = Math.max(0.5, Math.hypot(one[0], other[0]) / 2), b = Math.max(0.5, Math.hypot(one[1], other[1]) / 2);
    for (let j = 0, column = 0; j < rows; ++j)
      for (let i = 0; i < columns; ++i, ++column) {
        const u = zero[0] + i * one[0] + j * other[0] - left + 0.5, v = zero[1] + i * one[1] + j * other[1] - bottom + 0.5;
        if (u + a < 0 || v + b < 0 || u - a > width || v - b > height) continue;
        const x = Math.max(0, u - a), y = Math.max(0, v - b), right = Math.min(width, u + a), top = Math.min(height, v + b);
        const x0 = Math.min(Math.floor(x), width - 1), y0 = Math.min(Math.floor(y), height - 1);
        const x1 = Math.min(Math.floor(right), width - 1), y1 = Math.min(Math.floor(top), height - 1);
        const p0 = x - x0, q0 = y - y0, p1 = right - x1, q1 = top - y1;
        const low = y0 * stride, high = y1 * stride;
        let n = low + x0;
        let sum = (1 - q0) * ((1 - p0) * sums[n] + p0 * sums[n + 1]) + q0 * ((1 - p0) * sums[n + stride] + p0 * sums[n + stride + 1]);
        n = high + x1;
        sum += (1 - q1) * ((1 - p1) * sums[n] + p1 * sums[n + 1]) + q1 * ((1 - p1) * sums[n + stride] + p1 * sums[n + stride + 1]);
        n = low + x1;
        sum -= (1 - q0) * ((1 - p1) * sums[n] + p1 * sums[n + 1]) + q0 * ((1 - p1) * sums[n + stride] + p1 * sums[n + stride + 1]);
        n = high + x0;
        sum -= (1 - q1) * ((1 - p0) * sums[n] + p0 * sums[n + 1]) + q1 * ((1 - p0) * sums[n + stride] + p0 * sums[n + stride + 1]);
        if (sum > 0) take(column, sum / (4 * a * b));
      }
  }

  // Of the box of the field in the world.
  corners() {
    if (this.known_corners) return this.known_corners;
    const { to_own: m, origin, cell_size, cells } = this, [a, b, c, d, e, f, g, h, i] = m;
    const minors = [e * i - f * h, h * c - i * b, b * f - c * e, g * f - d * i, a * i - g * c,
      d * c - a * f, d * h - g * e, g * b - a * h, a * e - d * b];
    const determinant = a * minors[0] + d * minors[1] + g * minors[2];
    this.known_corners = Array.from({ length: 8 }, (_, corner) => {
      const own = [0, 1, 2].map(axis => origin[axis] + cell_size * (corner >> axis & 1 ? cells[axis] - 0.5 : -0.5) - m[9 + axis]);
      return [0, 1, 2].map(r => (minors[r] * own[0] + minors[3 + r] * own[1] + minors[6 + r] * own[2]) / determinant);
    });
    return this.known_corners;
  }

  // The same as 24 numbers for mesh_shadows.glsl.
  frame() {
    const { to_own, origin, cell_size, axis, across, aside, slopes, spread, is_above, low, high, left, bottom, width, height } = this;
    const row = r => [to_own[r], to_own[3 + r], to_own[6 + r], to_own[9 + r] - origin[r]].map(x => x / cell_size);
    return [...row(axis), ...row(across), ...row(aside), ...slopes, spread, is_above ? 1 : 0, low, high, 0, 0, left, bottom, width, height];
  }
}

/** The same field with cells that are so many times larger, for many shadows. @param {Caster} caster @returns {Caster} */
export function coarserCaster({ origin, cell_size, cells, fractions }, factor) {
  const coarse = /** @type {[number, number, number]} */ (cells.map(count => Math.ceil(count / factor)));
  const sums = new Float32Array(coarse[0] * coarse[1] * coarse[2]);
  let cell = 0;
  for (let z = 0; z < cells[2]; ++z)
    for (let y = 0; y < cells[1]; ++y)
      for (let x = 0; x < cells[0]; ++x)
        sums[(Math.floor(z / factor) * coarse[1] + Math.floor(y / factor)) * coarse[0] + Math.floor(x / factor)] += fractions[cell++];
  return {
    origin: origin.map(at => at + (factor - 1) / 2 * cell_size), cell_size: factor * cell_size, cells: coarse,
    fractions: Uint8Array.from(sums, sum => Math.round(sum / factor ** 3)),
  };
}
