// The layers of a scene beside its mesh clouds: pipeline/picture/scene_picture.h in WebGL2. Everything that takes long is drawn in bands of
// rows, so that a picture can be interrupted between two of them.

import { degreesOfDay, parabolaAt } from '../hours.js';
import { clamp, directionFromAngles, normalize } from '../vectors.js';
import { drawComposed, drawGraded } from './composition.js';
import { DustLight } from './dust.js';
import { MARCH, NOISE, NOISE_CLOUDS, SKY_FILES } from './layer_files.js';
import { LayerShadows } from './layer_shadows.js';
import { moonOfDay, skyValues, uploadMoon } from './night.js';

// What the time changes of the sky.
function moveSky(sky, day, time, offset) {
  if (sky.aurora) sky.aurora.time = time + offset;
  if (day && sky.stars) sky.stars.day_turn = degreesOfDay(day, time);
  if (!day || !sky.moon || !day.places_moon) return;
  const { direction, up } = moonOfDay(day, time, sky.moon.phase);
  Object.assign(sky.moon, day.turns_moon ? { direction, up } : { direction });
}

/** The settings of a scene's layers at the time and under the sun of a picture. @param {Scene} scene */
function settingsAt(scene, { sun, time }) {
  const { limits: _, by_sun, ...own } = scene.layers, settings = structuredClone(own), { day, terrain, sky } = settings;
  const to_sun = directionFromAngles(sun[0], sun[1]);
  for (const { path, rows } of by_sun?.values ?? []) {
    if (scene.written?.has(path.join('.'))) continue;  // by hand
    const table = path.slice(0, -1).reduce((found, part) => found[part], settings), mixed = parabolaAt(by_sun.heights, to_sun[1])(rows);
    table[path.at(-1)] = mixed.length === 1 ? mixed[0] : mixed;
  }
  if (terrain && by_sun?.snow_side) terrain.ground.snow_side = normalize([-to_sun[0], 0, -to_sun[2]]);
  moveSky(sky, day, time, scene.time_offset ?? 0);
  return settings;
}

export class SceneLayers {
  /** @param {Renderer} renderer */
  constructor(renderer) {
    this.renderer = renderer;
    this.gpu = renderer.gpu;
    this.shadows = new LayerShadows(this);
    this.dust = new DustLight(renderer);
    uploadMoon(this.gpu, renderer.scene.arrays.layers?.moon);
    this.rows = 16;  // of a band
  }

  // Begins a picture.
  begin(chosen) {
    this.settings = settingsAt(this.renderer.scene, chosen);
    this.isComposed = false;
  }

  get moon() { return this.settings.sky.moon; }

  // The uniforms of the sky's moon and stars.
  get skyValues() { return skyValues(this.settings.sky, !!this.renderer.scene.arrays.layers?.moon); }

  // The camera when the shutter opened, for motion blur; only a path moves it.
  wasAt(chosen) {
    const { motion_blur } = this.settings.grade;
    if (!motion_blur || !chosen.cameraAt) return undefined;
    return this.renderer.viewOf({ ...chosen, camera: chosen.cameraAt(chosen.time - motion_blur.shutter) });
  }

  // All clouds of noise, in the order in which they are composed; of a technique alone its own.
  get noiseClouds() {
    const { settings, settings: { only } } = this;
    const all = Object.keys(NOISE_CLOUDS).flatMap(kind => settings[kind].map((own, index) => ({ kind, index, settings: own })));
    return only ? all.filter(({ kind, index }) => String(only) === String([kind, index])) : all;
  }

  get ground() { return this.settings.only ? undefined : this.settings.terrain; }

  // Samples to a side of a pixel, of ground and clouds of noise: as many as the one that has the most. A draft has one.
  get samplesPerSide() {
    if (this.renderer.view.fewer > 1) return 1;
    return Math.max(1, this.ground?.samples_per_side ?? 1, ...this.noiseClouds.map(({ settings }) => settings.samples_per_side));
  }

  get size() {
    const { gpu: { size: { width, height } }, samplesPerSide: n } = this;
    return { width: n * width, height: n * height };
  }

  // Uniforms of every pass.
  get values() { return { ...this.renderer.view, samples_per_side: this.samplesPerSide, terrain: this.settings.terrain }; }

  get skyFiles() { return SKY_FILES; }

  // Draws the sky if the terrain has one of its own.
  drawSky() {
    const { gpu, settings: { terrain_sky } } = this;
    if (terrain_sky) gpu.fill([gpu.target('background')], gpu.program('terrain_sky.frag', [...NOISE, 'terrain', 'view']), this.values);
    return !!terrain_sky;
  }

  // --- Passes ---

  // Draws over targets in bands, or multiplies the one there is.
  *banded(targets, program, values, how = 'fill') {
    const { gpu, gpu: { gl } } = this, { width, height } = targets[0];
    for (let y = 0; y < height;) {
      const rows = this.renderer.view.fewer > 1 ? height : Math.min(height - y, this.rows);
      gl.enable(gl.SCISSOR_TEST);
      gl.scissor(0, y, width, rows);
      gpu[how](targets, program, values);
      gl.disable(gl.SCISSOR_TEST);
      y += rows;
      yield;
    }
  }

  // The rows of the next band follow from the milliseconds that the last one took.
  took(milliseconds, target) { this.rows = clamp(Math.round(this.rows * target / Math.max(milliseconds, 1)), 4, 4096); }

  // All layers; each step is a piece of work.
  *draw() {
    const { gpu, noiseClouds: clouds } = this, size = clouds.length ? this.size : { width: 1, height: 1 };
    gpu.clear([gpu.target('nothing', { width: 1, height: 1 })], [0, 0, 0, 0]);
    if (this.ground) yield* this.drawGround();
    const parts = gpu.arrayTarget('part colors', 3 * Math.max(1, clouds.length), size).layers;
    const places = gpu.arrayTarget('part places', Math.max(1, clouds.length), size).layers;
    for (const [i, cloud] of clouds.entries()) yield* this.drawNoiseCloud(cloud, parts.slice(3 * i, 3 * i + 3), places[i]);
    drawComposed(this);
    this.isComposed = true;
  }

  // The composed picture.
  show() { drawGraded(this); }

  // The cuts: surfaces that clouds of noise are before and behind.
  get cuts() {
    const surfaces = [...(this.renderer.hasClouds ? [['cloud', 1]] : []), ...(this.ground ? [['ground', this.samplesPerSide]] : [])];
    const [first, second] = surfaces, name = (surface, what) => surface ? `${surface[0]} ${what}` : 'nothing';
    return {
      cut_count: surfaces.length, cut_sides: [first?.[1] ?? 1, second?.[1] ?? 1],
      cuts_0: name(first, 'colors'), cut_places_0: name(first, 'places'),
      cuts_1: name(second, 'colors'), cut_places_1: name(second, 'places'),
    };
  }

  *drawGround() {
    const { gpu, size, values } = this, files = [...NOISE, 'terrain', 'view'], targets = names => names.map(name => gpu.target(name, size));
    yield* this.banded(targets(['ground hits', 'ground hit places']), gpu.program('terrain_hit.frag', files), values);
    const shares = yield* this.shadows.sharesOf('ground hits', 'ground hit places', 0, kind => kind !== 'terrain');
    yield* this.banded(targets(['ground colors', 'ground places']), gpu.program('terrain_color.frag', files),
      { ...values, hits: 'ground hits', hit_places: 'ground hit places', shares });
  }

  // The three parts of a cloud's colour, and its places, with the shadows of others.
  *drawNoiseCloud({ kind, index, settings }, colors, places) {
    if (kind === 'dust') {
      const program = this.gpu.program('dust.frag', [...NOISE_CLOUDS.dust.files, 'view', ...MARCH]);
      const values = { ...this.values, ...this.cuts, dust: settings, ...this.dust.values(index, settings) };
      yield* this.banded([...colors, places], program, values);
      return;
    }
    const { gpu, size } = this, drawn = ['part 0', 'part 1', 'part 2'].map(name => gpu.target(name, size));
    const distances = gpu.target('part distances', size);
    const own = { [NOISE_CLOUDS[kind].struct]: { ...settings, time: this.renderer.view.time } };
    yield* this.march(kind, [...drawn, distances], { ...this.values, ...this.cuts, ...own, sky_share: this.skyShare });
    const counts = (other, number) => (other !== kind || number !== index) && !(kind !== 'slabs' && other === 'mesh');
    for (const [part, { name }] of drawn.entries()) {
      const shares = yield* this.shadows.sharesOf(name, distances.name, part, counts);
      gpu.fill([colors[part]], gpu.program('darken.frag'), { colors: name, shares, sky_share: this.skyShare });
    }
    gpu.fill([places], gpu.program('copy.frag'), { image: distances.name });
    yield;
  }

  *march(kind, targets, values) {
    const { gpu, size } = this, { files } = NOISE_CLOUDS[kind];
    if (kind === 'slabs') {
      const marched = [0, 1, 2, 3].map(i => gpu.target(`slab march ${i}`, size));
      const names = Object.fromEntries(marched.map(({ name }, i) => [`march_${i}`, name]));
      yield* this.banded(marched, gpu.program('slab_march.frag', [...files, 'view', 'cuts']), values);
      yield* this.banded(targets, gpu.program('slab.frag', [...files, 'view']), { ...values, ...names });
    } else {
      const program = gpu.program('marched.frag', [...new Set([...SKY_FILES, ...files]), ...MARCH, 'mesh_shadows']);
      yield* this.banded(targets, program, { ...values, ...this.shadows.values });
    }
  }

  // The share of a marched cloud's colour that comes from the sky.
  get skyShare() {
    const { ambient_sky, light_color } = this.renderer.view;
    return ambient_sky.map((sky, i) => sky / (sky + light_color[i]));
  }
}
