// The shadow of a mesh cloud on others: preview/mesh_clouds/cloud_shadow.h.
'use strict';

class CloudShadow {
  // `caster`: the field of a cloud. `to_own`: from the world to its space, 3 × 3 by columns and the offset.
  constructor({ origin, cell_size, cells, fractions }, to_own, extinction, to_light, { strength, softness }) {
    Object.assign(this, { origin, cell_size, to_own });
    const own = this.vectorToOwn(to_light), sizes = own.map(Math.abs);
    const axis = sizes.indexOf(Math.max(...sizes)), across = (axis + 1) % 3, aside = (axis + 2) % 3;
    const slopes = [own[across] / own[axis], own[aside] / own[axis]], [u_slope, v_slope] = slopes;
    const slices = cells[axis], [u_far, v_far] = slopes.map(slope => -slope * (slices - 1));
    const left = Math.floor(Math.min(0, u_far)) - 1, bottom = Math.floor(Math.min(0, v_far)) - 1;
    const width = Math.ceil(cells[across] - 1 + Math.max(0, u_far)) + 2 - left, height = Math.ceil(cells[aside] - 1 + Math.max(0, v_far)) + 2 - bottom;
    const steps = [1, cells[0], cells[0] * cells[1]], per_slice = cell_size / sizes[axis];
    const cell = (k, b, c) => b < 0 || c < 0 || b >= cells[across] || c >= cells[aside] ? 0 : fractions[k * steps[axis] + b * steps[across] + c * steps[aside]];
    const isEmpty = k => {
      for (let c = 0; c < cells[aside]; ++c) for (let b = 0; b < cells[across]; ++b) if (cell(k, b, c)) return false;
      return true;
    };
    let first = 0, last = slices - 1;
    while (first < last && isEmpty(first)) ++first;
    while (last > first && isEmpty(last)) --last;
    const sums = new Float64Array((width + 1) * (height + 1));
    for (let j = 0; j < height; ++j)
      for (let i = 0; i < width; ++i) {
        let sum = 0;
        for (let k = first; k <= last; ++k) {
          const b = left + i + u_slope * k, c = bottom + j + v_slope * k, x = Math.floor(b), y = Math.floor(c), p = b - x, q = c - y;
          sum += (1 - q) * ((1 - p) * cell(k, x, y) + p * cell(k, x + 1, y)) + q * ((1 - p) * cell(k, x, y + 1) + p * cell(k, x + 1, y + 1));
        }
        const at = j * (width + 1) + i, above = at + width + 1;
        sums[above + 1] = sums[at + 1] + sums[above] - sums[at] + strength * (1 - Math.exp(-extinction * sum / 255 * per_slice));
      }
    const spread = Math.tan(softness * Math.PI / 180) * Math.hypot(...own) / sizes[axis];
    Object.assign(this, { axis, across, aside, slopes, spread, is_above: own[axis] > 0, low: first - 0.5, high: last + 0.5, left, bottom, width, height, sums });
  }

  vectorToOwn(v) { return [0, 1, 2].map(r => this.to_own[r] * v[0] + this.to_own[3 + r] * v[1] + this.to_own[6 + r] * v[2]); }

  integralTo(u, v) {
    const { left, bottom, width, height, sums } = this, x = clamp(u - left + 0.5, 0, width), y = clamp(v - bottom + 0.5, 0, height);
    const x0 = Math.min(Math.floor(x), width - 1), y0 = Math.min(Math.floor(y), height - 1), p = x - x0, q = y - y0, at = y0 * (width + 1) + x0, above = at + width + 1;
    return (1 - q) * ((1 - p) * sums[at] + p * sums[at + 1]) + q * ((1 - p) * sums[above] + p * sums[above + 1]);
  }

  shareAt(point) {
    const { to_own, origin, cell_size, low, high, slopes, spread, left, bottom, width, height } = this;
    const place = this.vectorToOwn(point).map((x, i) => (x + to_own[9 + i] - origin[i]) / cell_size), a = place[this.axis];
    const share = clamp((this.is_above ? high - a : a - low) / (high - low), 0, 1);
    if (!(share > 0)) return 1;
    const u = place[this.across] - slopes[0] * a, v = place[this.aside] - slopes[1] * a;
    const middle = this.is_above ? (Math.max(a, low) + high) / 2 : (Math.min(a, high) + low) / 2, half = Math.max(0.5, spread * Math.abs(middle - a));
    if (u + half < left || v + half < bottom || u - half > left + width || v - half > bottom + height) return 1;
    const sum = this.integralTo(u + half, v + half) - this.integralTo(u - half, v + half) - this.integralTo(u + half, v - half) + this.integralTo(u - half, v - half);
    const passed = clamp(1 - sum / (4 * half * half), 0, 1);
    return share < 1 ? passed ** share : passed;
  }

  // The same as 24 numbers for mesh_shadows.glsl.
  frame() {
    const { to_own, origin, cell_size, axis, across, aside, slopes, spread, is_above, low, high, left, bottom, width, height } = this;
    const row = r => [to_own[r], to_own[3 + r], to_own[6 + r], to_own[9 + r] - origin[r]].map(x => x / cell_size);
    return [...row(axis), ...row(across), ...row(aside), ...slopes, spread, is_above ? 1 : 0, low, high, 0, 0, left, bottom, width, height];
  }
}

// The shadows of all clouds that cast one, with the part of each.
function shadowsOf({ parts, casters, shadows, arrays: { fields } }, to_light, density) {
  return parts.filter(part => part.caster !== undefined).map(part =>
    Object.assign(new CloudShadow({ ...casters[part.caster], fractions: fields[part.caster] }, part.to_own, part.extinction * density, to_light, shadows), { part }));
}

// What comes of the light to each vertex of a scene past the other clouds.
function sharesOfLight({ parts, arrays: { positions } }, all_shadows) {
  const shares = new Float32Array(positions.length / 3).fill(1);
  for (const shadow of all_shadows)
    for (const other of parts)
      for (let v = other.first_vertex; other !== shadow.part && v < other.first_vertex + other.vertices; ++v)
        shares[v] *= shadow.shareAt(positions.subarray(3 * v, 3 * v + 3));
  return shares;
}
