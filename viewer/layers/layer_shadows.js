// What comes of the light past the layers of a scene that cast shadows: to its layers, and to the vertices of its clouds.

import { NOISE, NOISE_CLOUDS } from './layer_files.js';

const NO_ROW = [0, 0, 0, 0];

export class LayerShadows {
  /** @param {SceneLayers} layers */
  constructor(layers) {
    this.layers = layers;
    this.gpu = layers.renderer.gpu;
    this.count = 0;  // of mesh clouds that cast one
    this.upload([]);
    this.takeGrid({ grid: null, key: '' });
  }

  // The shadows of the mesh clouds as textures.
  upload(shadows) {
    const { gl } = this.gpu, largest = key => Math.max(1, ...shadows.map(shadow => shadow[key] + 1));
    const depth = Math.max(1, shadows.length), width = largest('width'), height = largest('height');
    this.count = shadows.length;
    const sums = new Float32Array(width * height * depth), frames = new Float32Array(6 * 4 * depth);
    for (const [index, shadow] of shadows.entries()) {
      for (let y = 0; y <= shadow.height; ++y)
        sums.set(shadow.sums.subarray(y * (shadow.width + 1), (y + 1) * (shadow.width + 1)), (index * height + y) * width);
      frames.set(shadow.frame(), 24 * index);
    }
    this.gpu.upload('shadow sums', { width, height, depth }, gl.R32F, gl.RED, sums);
    this.gpu.upload('shadow frames', { width: 6, height: depth }, gl.RGBA32F, gl.RGBA, frames);
  }

  // The grid of clouds that shade each other, as a texture; its clouds are not among the others.
  takeGrid({ grid, key }) {
    const grid_key = grid && this.layers.settings.has_shadows ? key : 'none';
    if (grid_key === this.gridKey) return;
    this.gridKey = grid_key;
    if (grid_key === 'none') {
      this.gpu.uploadShares('shade shares', [1, 1, 1], Float32Array.of(1));
      this.grid = { has_shade: false, shade_x: NO_ROW, shade_y: NO_ROW, shade_z: NO_ROW };
      return;
    }
    const { count, shares } = grid.pastAll, [shade_x, shade_y, shade_z] = grid.frame.rows;
    this.gpu.uploadShares('shade shares', count, shares);
    this.grid = { has_shade: true, shade_x, shade_y, shade_z };
  }

  get values() {
    const textures = { shadow_sums: 'shadow sums', shadow_frames: 'shadow frames', shade_shares: 'shade shares' };
    return { ...textures, shadow_count: this.count, ...this.grid };
  }

  // The passes of all things that cast a shadow: [kind, index, program, values].
  *passes() {
    const { gpu, layers: { settings, ground, noiseClouds, values, renderer } } = this;
    if (!settings.has_shadows) return;
    if (this.count || this.grid.has_shade) yield ['mesh', 0, gpu.program('pass_mesh.frag', ['mesh_shadows']), this.values];
    if (ground) yield ['terrain', 0, gpu.program('pass_terrain.frag', [...NOISE, 'terrain']), values];
    for (const { kind, index, settings: own } of noiseClouds) {
      const { struct, pass, files } = NOISE_CLOUDS[kind], shadow_strength = renderer.scene.shadows.strength;
      if (!pass) continue;
      yield [kind, index, gpu.program(pass, files), { ...values, [struct]: { ...own, time: renderer.view.time }, shadow_strength }];
    }
  }

  // The name of a target with the shares of the light that come to the places of a layer past those things that count.
  *sharesOf(colors, places, part, counts) {
    const { gpu, layers } = this, { size } = layers, shares = gpu.target('shares', size, gpu.blendedFormat);
    gpu.clear([shares], [1, 1, 1, 1]);
    const passes = [...this.passes()].filter(([kind, index]) => counts(kind, index));
    if (!passes.length) return shares.name;
    const points = gpu.target('points', size);
    gpu.fill([points], gpu.program('points.frag', ['view']), { ...layers.values, colors, places, part });
    for (const [, , program, values] of passes) yield* layers.banded([shares], program, { ...values, points: points.name }, 'multiply');
    return shares.name;
  }

  // What comes of the light to each vertex past ground and clouds of noise; null if there is nothing in its way.
  sharesOfVertices(positions) {
    const { gpu, gpu: { gl } } = this, passes = [...this.passes()].filter(([kind]) => kind !== 'mesh'), vertices = positions.length / 3;
    if (!passes.length || !vertices) return null;
    const width = Math.min(1024, vertices), size = { width, height: Math.ceil(vertices / width) };
    const points = new Float32Array(4 * size.width * size.height);
    for (let v = 0; v < vertices; ++v) points.set([positions[3 * v], positions[3 * v + 1], positions[3 * v + 2], 1], 4 * v);
    gpu.upload('vertex points', size, gl.RGBA32F, gl.RGBA, points);
    const shares = gpu.target('vertex shares', size, gpu.blendedFormat);
    gpu.clear([shares], [1, 1, 1, 1]);
    for (const [, , program, values] of passes) gpu.multiply([shares], program, { ...values, points: 'vertex points' });
    const found = new Float32Array(points.length);
    gpu.drawTo([shares]);
    gl.readPixels(0, 0, size.width, size.height, gl.RGBA, gl.FLOAT, found);
    return Float32Array.from({ length: vertices }, (_, v) => found[4 * v]);
  }
}
