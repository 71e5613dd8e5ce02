// Fields of clouds: a few meshes, once on the graphics card, of which every cloud is a copy. Where clouds are follows from the time:
// preview/mesh_clouds/scatter.h. A picture takes one draw call for each mesh and level that is seen.

import { levelOf, pixelsAcross } from './levels.js';
import { LIT_BY, LOCATIONS } from './programs.js';
import { indexType, litBy, sampleOf } from './vertices.js';

const NUMBERS = 6;  // of a cloud in field.clouds
const PER_CLOUD = 11;  // floats on the graphics card: three vectors
const LEAST_SHRINK = 1e-3;
const CORNERS = 8;  // of the box of an impostor
const LIGHT = { size: [1, 1, 1], numbers: Float32Array.of(1), shifts: new Float32Array(0) };  // of clouds in nobody's shade
const STILL = [0, 0, 0];
const NO_ROWS = [0, 1, 2].map(() => [0, 0, 0, 0]);

/** Where a cloud of a field is at a time: its place, the factor of its size, and cosine and sine of its turn. @param {Field} field */
export function placeAt({ clouds, low, high, drift, fade, horizon_scale, horizon_lower }, cloud, time) {
  const first = NUMBERS * cloud, at = [clouds[first], clouds[first + 1], clouds[first + 2]];
  let shrink = 1;
  for (let axis = 0; axis < 3; ++axis) {
    if (drift[axis] === 0) continue;
    const length = high[axis] - low[axis], boxes = (at[axis] - low[axis] + drift[axis] * time) / length, share = boxes - Math.floor(boxes);
    at[axis] = low[axis] + length * share;
    if (!(fade > 0)) continue;
    const t = Math.min(1, share / fade, (1 - share) / fade);
    shrink *= t * t * (3 - 2 * t);
  }
  const halves = axis => (2 * at[axis] - low[axis] - high[axis]) / (high[axis] - low[axis]);
  const square = Math.min(1, halves(0) ** 2 + halves(2) ** 2);
  shrink *= 1 + (horizon_scale - 1) * square;
  at[1] -= horizon_lower * square;
  const angle = clouds[first + 3] * Math.PI / 180;
  return { at, scale: clouds[first + 4] * Math.max(LEAST_SHRINK, shrink), angle, cosine: Math.cos(angle), sine: Math.sin(angle) };
}

// A vector that is turned about y, and a point that is made larger, turned and moved.
const turned = (v, cosine, sine) => [cosine * v[0] + sine * v[2], v[1], cosine * v[2] - sine * v[0]];
const moved = (point, { at, scale, cosine, sine }) => turned(point, cosine, sine).map((x, axis) => at[axis] + scale * x);

/**
 * The impostor of a cloud of a field.
 * @param {PlacedImpostor} own before it is scattered @param {ReturnType<typeof placeAt>} placed @returns {PlacedImpostor}
 */
function scatteredImpostor(own, placed, has_world_extinction) {
  const { scale, cosine, sine } = placed, columns = [0, 3, 6], columnsOf = matrix => columns.map(first => matrix.slice(first, first + 3));
  const rows = [0, 1, 2].map(r => columns.map(first => own.to_own[first + r] / scale)).map(row => turned(row, cosine, sine));
  return {
    ...own, center: moved(own.center, placed), radius: own.radius * scale, extinction: own.extinction / (has_world_extinction ? 1 : scale),
    to_own: [0, 1, 2].flatMap(c => rows.map(row => row[c])),
    to_world: columnsOf(own.to_world).flatMap(column => turned(column, cosine, sine).map(x => scale * x)),
  };
}

// A box around points that are made larger, turned and moved.
function boxOf(points, where) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (const point of points) {
    const placed = moved(point, where);
    for (let axis = 0; axis < 3; ++axis) {
      low[axis] = Math.min(low[axis], placed[axis]);
      high[axis] = Math.max(high[axis], placed[axis]);
    }
  }
  return { low, high };
}

// Whether something of a box may be in the picture: not all corners are behind the camera or beyond one side.
function isInView({ low, high }, { eye, right, up, forward, scale }) {
  const margin = 1.001, beyond = [0, 0, 0, 0, 0];
  for (let corner = 0; corner < 8; ++corner) {
    const x = (corner & 1 ? high : low)[0] - eye[0], y = (corner & 2 ? high : low)[1] - eye[1], z = (corner & 4 ? high : low)[2] - eye[2];
    const along = axis => axis[0] * x + axis[1] * y + axis[2] * z, w = along(forward);
    const across = along(right) * scale[0] / margin, above = along(up) * scale[1] / margin;
    [w < 0, across < -w, across > w, above < -w, above > w].forEach((is_beyond, side) => { beyond[side] += is_beyond ? 1 : 0; });
  }
  return beyond.every(corners => corners < 8);
}

export class Fields {
  /** @param {Gpu} gpu @param {Scene} scene */
  constructor(gpu, scene) {
    const { gl } = gpu, { arrays } = scene.scattered;
    this.gpu = gpu;
    this.scene = scene;
    this.all = [];  // clouds at the time of the picture
    this.groups = [];  // the clouds that are drawn as meshes, by part: { part, first, count }
    /** Those that are drawn as impostors. @type {DrawnImpostor[]} */
    this.impostors = [];
    this.buffers = [];
    this.meshes = gl.createVertexArray();
    gl.bindVertexArray(this.meshes);
    for (const [name, size, key] of /** @type {[string, number, keyof Arrays][]} */ ([
      ['mesh_position', 3, 'positions'], ['mesh_normal', 3, 'normals'], ['mesh_lobe', 4, 'lobes']])) {
      this.fill(gl.ARRAY_BUFFER, arrays[key]);
      this.point(name, size, 4 * size, 0);
    }
    for (let i = 0; i < 4; ++i) gl.vertexAttrib4f(LIT_BY.length + i, 0, 0, 0, 0);  // of coefficients that there are not
    if (arrays.colors?.length) {
      this.fill(gl.ARRAY_BUFFER, arrays.colors);
      this.point('own', 3, 12, 0);
    }
    const coefficients = arrays.harmonicsPerVertex;
    if (coefficients) this.fill(gl.ARRAY_BUFFER, arrays.harmonics);
    for (let i = 0; i < coefficients / 4; ++i) this.point(`harmonics_${i}`, 4, 4 * coefficients, 16 * i);
    this.fill(gl.ELEMENT_ARRAY_BUFFER, arrays.triangles);
    this.clouds = gl.createBuffer();
    this.buffers.push(this.clouds);
    for (const name of ['cloud_place', 'cloud_light', 'cloud_shade']) gl.vertexAttribDivisor(LOCATIONS[name], 1);
    gl.bindVertexArray(null);
  }

  delete() {
    const { gl } = this.gpu;
    for (const buffer of this.buffers) gl.deleteBuffer(buffer);
    gl.deleteVertexArray(this.meshes);
  }

  fill(kind, data) {
    const { gl } = this.gpu, buffer = gl.createBuffer();
    this.buffers.push(buffer);
    gl.bindBuffer(kind, buffer);
    gl.bufferData(kind, data, gl.STATIC_DRAW);
  }

  // An attribute of the buffer that is bound.
  point(name, size, stride, offset) {
    const { gl } = this.gpu;
    gl.enableVertexAttribArray(LOCATIONS[name]);
    gl.vertexAttribPointer(LOCATIONS[name], size, gl.FLOAT, false, stride, offset);
  }

  /**
   * Chooses the levels of the clouds of a picture, and lights them. `sharesAt`: what comes of the light to points past other things.
   * @param {View} view @param {import('./cloud_shade.js').CloudShade} shade @param {(points: Float32Array) => Float32Array} sharesAt
   */
  place(view, shade, sharesAt) {
    const { parts } = this.scene.scattered, { all } = this, drawn = parts.map(() => []);
    for (const [i, { part, seen }] of all.entries())
      if (isInView(seen, view)) drawn[levelOf(parts, part, () => pixelsAcross(seen, view))].push(i);
    this.placeImpostors(drawn, shade, sharesAt);
    const order = drawn.flat(), shares = sharesAt(new Float32Array(order.flatMap(i => all[i].center)));
    const is_shaded = shade.grid && shade.kind !== 'none' && order.length > 0;
    const { size, numbers, shifts } = is_shaded ? shade.blocksOf(order.map(i => all[i])) : LIGHT;
    const [x, y, z] = is_shaded ? shade.grid.frame.rows : NO_ROWS;
    this.gpu.uploadShares('cloud shades', size, numbers);
    this.shade = { cloud_shades: 'cloud shades', shade_x: x, shade_y: y, shade_z: z };
    const data = new Float32Array(PER_CLOUD * order.length);
    for (const [k, i] of order.entries()) {
      const { placed: { at, scale, cosine, sine }, field } = all[i];
      const power = field.has_world_extinction ? scale : 1, shift = is_shaded ? shifts.subarray(3 * k, 3 * k + 3) : STILL;
      data.set([...at, scale, cosine, sine, shares[k], power, ...shift], PER_CLOUD * k);
    }
    const { gl } = this.gpu;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.clouds);
    gl.bufferData(gl.ARRAY_BUFFER, data, gl.DYNAMIC_DRAW);
    gl.bindBuffer(gl.ARRAY_BUFFER, null);
    let first = 0;
    this.groups = drawn.map((clouds, i) => {
      first += clouds.length;
      return { part: parts[i], first: first - clouds.length, count: clouds.length };
    }).filter(({ count }) => count > 0);
  }

  // Takes the clouds that are impostors out of those that are drawn, by part. The light that comes to one past other things is the mean at
  // the corners of its box.
  placeImpostors(drawn, shade, sharesAt) {
    const { parts, arrays } = this.scene.scattered;
    const taken = parts.flatMap((part, i) => part.impostor ? drawn[i].splice(0).map(cloud => ({ part, cloud: this.all[cloud] })) : []);
    const corners = new Float32Array(taken.flatMap(({ part: { first_vertex }, cloud: { placed } }) =>
      Array.from({ length: CORNERS }, (_, v) => 3 * (first_vertex + v)).flatMap(v => moved(arrays.positions.subarray(v, v + 3), placed))));
    const shares = taken.length ? sharesAt(corners) : corners;
    this.impostors = taken.map(({ part, cloud, cloud: { placed, field } }, i) => {
      const first = CORNERS * i;
      shade.darkenPoints(corners, first, CORNERS, shade.numberOf(cloud), shares);
      const share = shares.subarray(first, first + CORNERS).reduce((sum, one) => sum + one / CORNERS, 0);
      return { one: scatteredImpostor(part.impostor, placed, field.has_world_extinction), share, pictures: 'scattered' };
    });
  }

  // Places all clouds.
  moveTo(time) {
    if (time !== this.time) this.all = this.allAt(time);
    this.time = time;
  }

  // All clouds at a time, with their boxes.
  allAt(time) {
    const all = [];
    for (const field of this.scene.scattered.fields)
      for (let cloud = 0; NUMBERS * cloud < field.clouds.length; ++cloud) {
        const placed = placeAt(field, cloud, time), { part, corners, longest } = field.meshes[field.clouds[NUMBERS * cloud + 5]];
        const { low, high } = boxOf(corners, placed), center = low.map((x, axis) => (x + high[axis]) / 2);
        all.push({ placed, field, part, center, seen: { low, high, longest: longest * placed.scale } });
      }
    return all;
  }

  /** The clouds as triangles; `place`: of the sample in the pixel; `shown`: SHOWN of chains.js. @param {View} view @param {Look} look */
  draw(fragment, view, look, size, place, shown) {
    const { gl } = this.gpu, { scene, scene: { scattered: { arrays, arrays: { triangles } } } } = this, type = indexType(gl, arrays);
    const { half_lambert, half_lambert_sky, volume_gain } = look, of_error = view.show === 'error';
    // Of the other lights nothing is known here; harmonics have all their orders.
    const known = light => light.startsWith('harmonics') ? 'harmonics' : light === 'none' ? light : 'lobe';
    const lit = { ...view, light: known(view.light), against: known(view.against) };
    const values = { ...view, ...this.shade, half_lambert, half_lambert_sky, of_error, ...sampleOf(view, size, place, shown) };
    const program = this.gpu.program(fragment, ['channels'], 'field.vert',
      ['lobe', 'harmonics', 'lamp', 'lamps', 'own_channels']);
    gl.bindVertexArray(this.meshes);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.clouds);
    for (const { part, first, count } of this.groups) {
      this.gpu.use(program, { ...values, ...litBy(scene, part, lit, volume_gain) });
      this.point('cloud_place', 4, 4 * PER_CLOUD, 4 * PER_CLOUD * first);
      this.point('cloud_light', 4, 4 * PER_CLOUD, 4 * PER_CLOUD * first + 16);
      this.point('cloud_shade', 3, 4 * PER_CLOUD, 4 * PER_CLOUD * first + 32);
      gl.drawElementsInstanced(gl.TRIANGLES, part.count, type, part.first * triangles.BYTES_PER_ELEMENT, count);
    }
    gl.bindBuffer(gl.ARRAY_BUFFER, null);
    gl.bindVertexArray(null);
  }
}
