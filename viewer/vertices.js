// The vertices of a scene on the graphics card, and the light that reaches them, left and right of the divider.

import { levelOf, pixelsAcross } from './levels.js';
import { LIT_BY, LOCATIONS } from './programs.js';
import { sharesOfLight, shadowsOf } from './shadows.js';

// Their numbers in light.vert, and the order of harmonics. The volume is not drawn with vertices.
const LIGHTS = {
  lobe: [0], compared: [1], harmonics: [2, 3], harmonics2: [2, 2], harmonics1: [2, 1], exact: [3], lambert: [4], blended: [5], truth: [6],
  lattice: [7],
};
const UNTURNED = [1, 0, 0, 0, 1, 0, 0, 0, 1];

/** The part whose values the sliders show; that of a scene without mesh clouds has none. @param {Scene} scene @returns {Shape} */
export const firstPart = ({ parts, scattered }) => parts[0] ?? scattered?.parts[0] ?? { shape: [3, 0], lobe: 'mean', extinction: 1 };

/** k and b of a part, moved as those of the first part were. @param {Scene} scene @param {Part} part */
export function shapeOf(scene, { shape: [k, b] }, chosen) {
  const [first_k, first_b] = firstPart(scene).shape;
  return [k + chosen.k - first_k, b + chosen.b - first_b];
}

/**
 * The uniforms of the light of a part. `latticed`: the parts that are in a lattice.
 * @param {Scene} scene @param {Part} part @param {View} view @param {number} volume_gain of the look @param {Set<Part>} [latticed]
 */
export function litBy(scene, part, view, volume_gain, latticed) {
  const { light, against, density } = view, sides = [light, against === 'none' ? light : against].map(name => {
    const own = LIGHTS[name] ?? LIGHTS.lobe;
    const has = [true, part.compared, part.harmonics, true, true, true, true, latticed?.has(part)];
    return has[own[0]] ? own : LIGHTS.lobe;
  });
  const lights = sides.map(([number]) => number), orders = sides.map(([, order = 0]) => order);
  const of_volume = [part.is_of_volume, part.compared?.is_of_volume, part.harmonics?.is_of_volume];
  const gainOf = number => (of_volume[number === 5 ? 0 : number] ? volume_gain : 1);
  const { harmonics: { extinction: own_extinction, to_own } = { extinction: 1, to_own: UNTURNED } } = part;
  return {
    lights, orders, gains: lights.map(gainOf), shape: shapeOf(scene, part, view),
    compared_shape: part.compared?.shape ?? part.shape, extinction: part.extinction * density, own_extinction, to_own,
  };
}

/**
 * The uniforms of a sample at a place in the pixel. The light of lamps is the same on both sides of the divider, and may be more than 1.
 * @param {View} view @param {{ width: number, height: number }} size @param {number[]} place
 */
export const sampleOf = (view, { width, height }, [x, y], shown = 0) =>
  ({ place: [(2 * x - 1) / width, (1 - 2 * y) / height], divider: shown ? 1e9 : view.split * width, most: shown ? 6e4 : 1, shown });

/** The triangles of an array of vertices as WebGL takes them. @param {WebGL2RenderingContext} gl @param {Arrays} arrays */
export const indexType = (gl, { triangles }) => triangles.BYTES_PER_ELEMENT === 4 ? gl.UNSIGNED_INT : gl.UNSIGNED_SHORT;

export class Vertices {
  /** @param {Gpu} gpu @param {Scene} scene */
  constructor(gpu, scene) {
    this.gpu = gpu;
    this.scene = scene;
    this.buffers = {};
    const { gl } = gpu, { arrays } = scene;
    this.lit = gl.createVertexArray();
    gl.bindVertexArray(this.lit);
    for (const [key, name, size] of LIT_BY) if (arrays[key]?.length) this.setAttribute(name, size, arrays[key]);
    for (let i = 0; i < 4; ++i) gl.vertexAttrib4f(LIT_BY.length + i, 0, 0, 0, 0);  // of coefficients that there are not
    gl.vertexAttrib1f(LOCATIONS.sun_share, 1);  // of clouds in nobody's shadow
    gl.vertexAttrib3f(LOCATIONS.own, 1, 1, 1);  // of white clouds
    if (arrays.harmonicsPerVertex) this.setHarmonics(arrays);
    this.drawn = gl.createVertexArray();
    if (scene.lamps) this.setAttribute('mesh_position', 3, arrays.positions);
    gl.bindVertexArray(this.drawn);
    this.setAttribute('position', 3, arrays.positions);
    if (arrays.colors?.length) this.setAttribute('own', 3, arrays.colors);
    const dark = new Float32Array(4 * arrays.positions.length / 3);
    this.setAttribute('light', 4, dark);
    if (scene.lamps) {
      gl.bindBuffer(gl.ARRAY_BUFFER, this.buffer('lamps'));
      gl.bufferData(gl.ARRAY_BUFFER, dark, gl.STATIC_DRAW);
    }
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.buffer('triangles'));
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, arrays.triangles, gl.STATIC_DRAW);
    gl.bindVertexArray(null);
  }

  delete() {
    const { gl } = this.gpu;
    for (const buffer of Object.values(this.buffers)) gl.deleteBuffer(buffer);
    for (const object of [this.lit, this.drawn]) gl.deleteVertexArray(object);
  }

  buffer(name) { return this.buffers[name] ??= this.gpu.gl.createBuffer(); }

  // Fills the buffer of an attribute of the vertex array that is bound.
  setAttribute(name, size, data) {
    const { gl } = this.gpu;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffer(name));
    gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
    gl.enableVertexAttribArray(LOCATIONS[name]);
    gl.vertexAttribPointer(LOCATIONS[name], size, gl.FLOAT, false, 0, 0);
    gl.bindBuffer(gl.ARRAY_BUFFER, null);
  }

  setHarmonics({ harmonicsPerVertex, harmonics }) {
    const { gl } = this.gpu;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffer('harmonics'));
    gl.bufferData(gl.ARRAY_BUFFER, harmonics, gl.STATIC_DRAW);
    for (let i = 0; i < harmonicsPerVertex / 4; ++i) {
      gl.enableVertexAttribArray(LOCATIONS[`harmonics_${i}`]);
      gl.vertexAttribPointer(LOCATIONS[`harmonics_${i}`], 4, gl.FLOAT, false, 4 * harmonicsPerVertex, 16 * i);
    }
    gl.bindBuffer(gl.ARRAY_BUFFER, null);
  }

  setLitBy(name, size, data) {
    const { gl } = this.gpu;
    gl.bindVertexArray(this.lit);
    this.setAttribute(name, size, data);
    gl.bindVertexArray(null);
  }

  // Exact lengths from every vertex to sun and sky, two floats each.
  setLengths(lengths) {
    this.lightsKey = null;
    this.setLitBy('lengths', 2, lengths);
  }

  // The shadows that placed clouds cast one by one, and what comes of the light to each vertex past them. With a grid there are none.
  castOwnShadows({ to_light, density }, layers, kind) {
    const { scene } = this, key = JSON.stringify([to_light, density, scene.shadows]);
    if (key === this.cloudSharesKey) return;
    this.cloudSharesKey = key;
    const shadows = kind === 'grid' ? [] : shadowsOf(scene, to_light, density);
    layers?.shadows.upload(shadows.map(({ shadow }) => shadow));
    this.cloudShadows = kind === 'none' ? [] : shadows;
    this.cloudShares = sharesOfLight(scene, this.cloudShadows);
  }

  // What comes of the light to each vertex past other things.
  castShadows(view, layers, shade) {
    const { scene, scene: { arrays: { positions } } } = this;
    if (!(scene.casters.length || scene.layers || shade.grid)) return;
    this.castOwnShadows(view, layers, shade.kind);
    const key = JSON.stringify([this.cloudSharesKey, shade.grid && shade.key, layers && [view.time, layers.settings]]);
    if (key === this.sharesKey) return;
    this.sharesKey = key;
    const others = layers?.shadows.sharesOfVertices(positions), shares = this.cloudShares.slice();
    for (const part of scene.parts) shade.darken(part, scene.parts[part.level?.of] ?? part, positions, shares);
    this.sunShares = others ? shares.map((share, v) => share * others[v]) : shares;
    this.setLitBy('sun_share', 1, this.sunShares);
  }

  /** The mean of what comes of the light to the vertices of a part past other things. @param {Part} part */
  shareOf({ first_vertex: first, vertices }) {
    return this.sunShares?.subarray(first, first + vertices).reduce((sum, share) => sum + share / vertices, 0) ?? 1;
  }

  // The light of the volume that the eye sees through each vertex.
  see(view, volume) {
    const key = JSON.stringify([view.eye, view.to_light, view.density, volume.sunOfLengths]), { gl } = this.gpu;
    if (key === this.seenKey) return;
    this.seenKey = key;
    const vertices = this.scene.arrays.positions.length / 3;
    if (!this.buffers.seen) this.setLitBy('seen', 2, new Float32Array(2 * vertices));
    this.gpu.use(this.gpu.program('depth.frag', [], 'seen.vert', ['light', 'march'], ['light_seen']),
      { ...view, ...volume.values(view.density) });
    gl.bindVertexArray(this.drawn);
    gl.enable(gl.RASTERIZER_DISCARD);
    gl.bindBufferBase(gl.TRANSFORM_FEEDBACK_BUFFER, 0, this.buffers.seen);
    gl.beginTransformFeedback(gl.POINTS);
    gl.drawArrays(gl.POINTS, 0, vertices);
    gl.endTransformFeedback();
    gl.bindBufferBase(gl.TRANSFORM_FEEDBACK_BUFFER, 0, null);
    gl.disable(gl.RASTERIZER_DISCARD);
    gl.bindVertexArray(null);
  }

  // The light of the lattices of dust at the vertices of the clouds that are in them.
  takeLattices(view, layers) {
    const key = JSON.stringify([view.to_light, view.density]), { parts, arrays: { positions } } = this.scene;
    if (key === this.latticesKey) return;
    this.latticesKey = key;
    const all = new Float32Array(positions.length / 3 * 2);
    this.latticed = new Set(parts.filter(part => {
      const shares = layers.dust.sharesOfVertices(part, view);
      if (shares) all.set(shares, 2 * part.first_vertex);
      return shares;
    }));
    this.setLitBy('latticed', 2, all);
  }

  // What comes of the light to points, three numbers each, past the clouds of `parts` and other layers.
  sharesAt(points, layers) {
    const shares = layers?.shadows.sharesOfVertices(points) ?? new Float32Array(points.length / 3).fill(1);
    for (const { shadow } of this.cloudShadows ?? [])
      for (let i = 0; i < shares.length; ++i) shares[i] *= shadow.shareAt(points.subarray(3 * i, 3 * i + 3));
    return shares;
  }

  // Computes the light that reaches each vertex, where anything of it has changed.
  light(view, { half_lambert, half_lambert_sky, volume_gain }, layers, volume, shade) {
    this.castShadows(view, layers, shade);
    if (volume && [view.light, view.against].includes('truth')) this.see(view, volume);
    if (layers && [view.light, view.against].includes('lattice')) this.takeLattices(view, layers);
    const { gl } = this.gpu, files = ['lobe', 'harmonics', 'lamp', 'lamps'];
    const program = this.gpu.program('depth.frag', [], 'light.vert', files, ['shade']);
    const { to_light, light, against, density, k, b, show, lamps } = view, of_error = show === 'error';
    const chosen = [to_light, light, against, density, k, b, half_lambert, half_lambert_sky, volume_gain, of_error, lamps];
    const key = JSON.stringify([this.sharesKey, this.seenKey, this.latticesKey, ...chosen]);
    if (key === this.lightsKey) return;
    this.lightsKey = key;
    gl.bindVertexArray(this.lit);
    gl.enable(gl.RASTERIZER_DISCARD);
    for (const buffer of view.lamp_count ? ['light', 'lamps'] : ['light'])
      for (const part of this.scene.parts) {
        this.gpu.use(program, { ...view, ...litBy(this.scene, part, view, volume_gain, this.latticed), to_sun: to_light, of_error,
          half_lambert, half_lambert_sky, of_lamps: buffer === 'lamps' });
        gl.bindBufferRange(gl.TRANSFORM_FEEDBACK_BUFFER, 0, this.buffers[buffer], 16 * part.first_vertex, 16 * part.vertices);
        gl.beginTransformFeedback(gl.POINTS);
        gl.drawArrays(gl.POINTS, part.first_vertex, part.vertices);
        gl.endTransformFeedback();
      }
    gl.bindBufferBase(gl.TRANSFORM_FEEDBACK_BUFFER, 0, null);
    gl.disable(gl.RASTERIZER_DISCARD);
    gl.bindVertexArray(null);
  }

  // The triangles of the clouds, each at the level that is drawn there: [first, count] of the indices, neighbours together.
  rangesIn(view) {
    const { parts, arrays: { triangles } } = this.scene;
    if (!parts.some(part => part.level)) return [[0, triangles.length]];
    const ranges = [];
    parts.forEach((part, i) => {
      if (part.level) return;
      const { first, count } = parts[levelOf(parts, i, () => pixelsAcross(part.seen, view))], last = ranges.at(-1);
      if (last && last[0] + last[1] === first) last[1] += count;
      else ranges.push([first, count]);
    });
    return ranges;
  }

  // The clouds as triangles; `place`: of the sample in the pixel; `shown`: SHOWN of chains.js.
  draw(fragment, view, size, place, values = {}, shown = 0) {
    const { gl } = this.gpu, { arrays, arrays: { triangles } } = this.scene, type = indexType(gl, arrays);
    const program = this.gpu.program(fragment, ['channels'], 'cloud.vert', ['own_channels']);
    this.gpu.use(program, { ...view, ...values, ...sampleOf(view, size, place, shown) });
    gl.bindVertexArray(this.drawn);
    const of_lamps = shown === 1 || shown === 2;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffers[of_lamps ? 'lamps' : 'light']);
    gl.vertexAttribPointer(LOCATIONS.light, of_lamps ? 2 : 4, gl.FLOAT, false, 16, shown === 2 ? 8 : 0);
    gl.bindBuffer(gl.ARRAY_BUFFER, null);
    for (const [first, count] of this.rangesIn(view)) gl.drawElements(gl.TRIANGLES, count, type, first * triangles.BYTES_PER_ELEMENT);
    gl.bindVertexArray(null);
  }
}
