// The layers of a scene beside its mesh clouds, and their composition: pipeline/picture/scene_picture.h in WebGL2. Everything that takes long
// is drawn in bands of rows, so that a picture can be interrupted between two of them.
'use strict';

const smoothStep = (a, b, x) => {
  const t = clamp((x - a) / (b - a), 0, 1);
  return t * t * (3 - 2 * t);
};

// The light that reaches clouds and ground: of the sun, or at night of the moon. keyLight of preview/backdrop/sky.h.
function keyLight(to_sun, sun_color, moon) {
  if (!moon) return { to_light: to_sun, light_color: sun_color };
  const change = -0.1, scaled = (color, factor) => color.map(x => x * factor);
  if (to_sun[1] > change) return { to_light: to_sun, light_color: scaled(sun_color, smoothStep(change, 0, to_sun[1])) };
  const of_phase = (0.5 + 0.5 * Math.cos(moon.phase * Math.PI / 180)) * smoothStep(-0.05, 0.05, moon.direction[1]);
  return { to_light: moon.direction, light_color: scaled(moon.light, of_phase * smoothStep(change, -0.2, to_sun[1])) };
}

const NOISE = ['noise', 'shading'];  // the files of functions that all of these use

// The uniforms of a night sky, also of one that has no moon or no stars.
function skyValues({ smooth, smooth_disc, moon, stars, craters }) {
  const direction = [0, 1, 0];
  return {
    has_smooth_disc: !!smooth, has_moon: !!moon, has_stars: !!stars, smooth_disc,
    moon: moon ?? { direction, up: [1, 0, 0], disc_exponent: 1, disc_gain: 1, color: direction, phase: 0 }, craters: craters ?? Array(24).fill([0, 0, 0, 1]),
    stars: stars ?? { count: 100, brightness: 0, size: 1, tint: 0, low_height: 0, high_height: 1, seed: 0, pole: direction, turn: 0 },
  };
}

const SKY_FILES = [...NOISE, 'sky', 'night', 'view', 'sky_uniforms', 'night_sky'];

// The clouds of noise by kind: the name of their settings, the pass of their shadows, and the files of both.
const NOISE_CLOUDS = {
  slabs: { struct: 'slab', pass: 'pass_slab.frag', files: [...NOISE, 'random', 'samples', 'slab'] },
  distance: { struct: 'marched', pass: 'pass_marched.frag', files: [...NOISE, 'random', 'samples', 'marched', 'distance_clouds'] },
  density: { struct: 'marched', pass: 'pass_marched.frag', files: [...NOISE, 'random', 'samples', 'marched', 'density_clouds'] },
};

// The moon opposite to the sun if it is full, with its lit side towards the sun.
function moonOfDay(day, time, phase) {
  const sun_degrees = degreesOfDay(day, time), direction = onSunCircle(day, phase < 0 ? sun_degrees + (180 + phase) : sun_degrees - (180 - phase));
  const sun = onSunCircle(day, sun_degrees), across = add(sun, direction, -dot(sun, direction)), size = Math.hypot(...across);
  const axis = cross(directionFromAngles(day.noon[0] - 90, 0), directionFromAngles(...day.noon));
  const lit_side = size > 0 ? across.map(x => x * (phase < 0 ? -1 : 1) / size) : cross(direction, normalize(axis));
  return { direction, up: cross(lit_side, direction) };
}

class SceneLayers {
  constructor(renderer) {
    this.renderer = renderer;
    this.rows = 16;  // of a band
  }

  // The settings at the time and under the sun of a picture.
  setMoment({ sun, time }) {
    const { scene } = this.renderer, { limits, by_sun, ...own } = scene.layers, settings = structuredClone(own), { day, terrain } = settings, to_sun = directionFromAngles(...sun);
    for (const { path, rows } of by_sun?.values ?? []) {
      if (scene.written?.has(path.join('.'))) continue;  // by hand
      const table = path.slice(0, -1).reduce((found, part) => found[part], settings), mixed = parabolaAt(by_sun.heights, to_sun[1])(rows);
      table[path.at(-1)] = mixed.length === 1 ? mixed[0] : mixed;
    }
    if (terrain && by_sun?.snow_side) terrain.ground.snow_side = normalize([-to_sun[0], 0, -to_sun[2]]);
    if (day && settings.sky.stars) settings.sky.stars.turn = degreesOfDay(day, time);
    if (day && settings.sky.moon && day.places_moon) Object.assign(settings.sky.moon, moonOfDay(day, time, settings.sky.moon.phase));
    this.settings = settings;
  }

  // The light that counts, and the sky's moon and stars.
  light(to_sun, { sun_color }) {
    const { sky } = this.settings;
    return { ...keyLight(to_sun, sun_color, sky.moon), ...skyValues(sky) };
  }

  // The camera when the shutter opened, for motion blur; only a path moves it.
  wasAt(chosen) {
    const { renderer, settings } = this;
    if (!settings.grade.motion_blur || !chosen.cameraAt) return undefined;
    return renderer.frame({ ...chosen, camera: chosen.cameraAt(chosen.time - settings.grade.motion_blur.shutter) });
  }

  // All clouds of noise, in the order in which they are composed; of a technique alone its own.
  get noiseClouds() {
    const { only } = this.settings, all = Object.keys(NOISE_CLOUDS).flatMap(kind => this.settings[kind].map((settings, index) => ({ kind, index, settings })));
    return only ? all.filter(({ kind, index }) => String(only) === String([kind, index])) : all;
  }

  get ground() { return this.settings.only ? undefined : this.settings.terrain; }

  // Samples to a side of a pixel, of ground and clouds of noise: as many as the one that has the most. A draft has one.
  get samplesPerSide() {
    return this.renderer.view.fewer > 1 ? 1 : Math.max(1, this.ground?.samples_per_side ?? 1, ...this.noiseClouds.map(({ settings }) => settings.samples_per_side));
  }

  get size() {
    const { size: { width, height } } = this.renderer, n = this.samplesPerSide;
    return { width: n * width, height: n * height };
  }

  // Uniforms of every pass.
  get values() {
    const { renderer } = this, { view } = renderer;
    return { ...view, samples_per_side: this.samplesPerSide, terrain: this.settings.terrain };
  }

  // --- Passes ---

  // Draws over targets in bands, or multiplies the one there is.
  *banded(targets, program, values, how = 'fill') {
    const { gl } = this.renderer, { width, height } = targets[0];
    for (let y = 0; y < height;) {
      const rows = this.renderer.view.fewer > 1 ? height : Math.min(height - y, this.rows);
      gl.enable(gl.SCISSOR_TEST);
      gl.scissor(0, y, width, rows);
      this.renderer[how](targets, program, values);
      gl.disable(gl.SCISSOR_TEST);
      y += rows;
      yield;
    }
  }

  // The rows of the next band follow from the milliseconds that the last one took.
  took(milliseconds, target) { this.rows = clamp(Math.round(this.rows * target / Math.max(milliseconds, 1)), 4, 4096); }

  clear(target, ...color) {
    const { gl } = this.renderer;
    this.renderer.drawTo([target]);
    gl.clearBufferfv(gl.COLOR, 0, color);
  }

  // All layers; each step is a piece of work.
  *draw() {
    const { renderer } = this;
    this.clear(renderer.target('nothing', { width: 1, height: 1 }), 0, 0, 0, 0);
    if (this.ground) yield* this.drawGround();
    const clouds = this.noiseClouds;
    const size = clouds.length ? this.size : { width: 1, height: 1 };
    this.parts = renderer.arrayTarget('part colors', 3 * Math.max(1, clouds.length), size);
    this.places = renderer.arrayTarget('part places', Math.max(1, clouds.length), size);
    for (const [number, cloud] of clouds.entries()) yield* this.drawNoiseCloud(cloud, number);
    this.compose();
  }

  // The cuts: surfaces that clouds of noise are before and behind.
  get cuts() {
    const surfaces = [...(this.renderer.hasClouds ? [['cloud', 1]] : []), ...(this.ground ? [['ground', this.samplesPerSide]] : [])], [first, second] = surfaces;
    const name = (surface, what) => surface ? `${surface[0]} ${what}` : 'nothing';
    return {
      cut_count: surfaces.length, cut_sides: [first?.[1] ?? 1, second?.[1] ?? 1],
      cuts_0: name(first, 'colors'), cut_places_0: name(first, 'places'), cuts_1: name(second, 'colors'), cut_places_1: name(second, 'places'),
    };
  }

  *drawGround() {
    const { renderer, size, values } = this, hits = ['ground hits', 'ground hit places'].map(name => renderer.target(name, size));
    yield* this.banded(hits, renderer.program('terrain_hit.frag', [...NOISE, 'terrain', 'view']), values);
    const shares = yield* this.sharesOf('ground hits', 'ground hit places', 0, (kind) => kind !== 'terrain');
    yield* this.banded(['ground colors', 'ground places'].map(name => renderer.target(name, size)), renderer.program('terrain_color.frag', [...NOISE, 'terrain', 'view']),
      { ...values, hits: 'ground hits', hit_places: 'ground hit places', shares });
  }

  *drawNoiseCloud({ kind, index, settings }, number) {
    const { renderer, size } = this, { struct, files } = NOISE_CLOUDS[kind], time = renderer.view.time;
    const values = { ...this.values, ...this.cuts, [struct]: { ...settings, time }, sky_share: this.skyShare };
    const drawn = [0, 1, 2].map(part => renderer.target(`part ${part}`, size)), places = renderer.target('part distances', size);
    if (kind === 'slabs') {
      const marched = [0, 1, 2, 3].map(i => renderer.target(`slab march ${i}`, size));
      yield* this.banded(marched, renderer.program('slab_march.frag', [...files, 'view', 'cuts']), values);
      yield* this.banded([...drawn, places], renderer.program('slab.frag', [...files, 'view']), { ...values, ...Object.fromEntries(marched.map(({ name }, i) => [`march_${i}`, name])) });
    } else {
      yield* this.banded([...drawn, places], renderer.program('marched.frag', [...new Set([...SKY_FILES, ...files]), 'cuts', 'mesh_shadows']), { ...values, ...this.shadowValues });
    }
    const is_marched = kind !== 'slabs';
    for (const part of [0, 1, 2]) {
      const shares = yield* this.sharesOf(drawn[part].name, places.name, part, (other, other_index) => (other !== kind || other_index !== index) && !(is_marched && other === 'mesh'));
      renderer.fill([this.parts.layers[3 * number + part]], renderer.program('darken.frag'), { colors: drawn[part].name, shares, sky_share: this.skyShare });
    }
    renderer.fill([this.places.layers[number]], renderer.program('copy.frag'), { image: places.name });
    yield;
  }

  // --- Shadows ---

  // The share of a marched cloud's colour that comes from the sky.
  get skyShare() {
    const { ambient_sky, light_color } = this.renderer.view;
    return ambient_sky.map((sky, i) => sky / (sky + light_color[i]));
  }

  // The passes of all things that cast a shadow: [kind, index, program, values].
  *things() {
    const { renderer, settings, values } = this;
    if (!settings.has_shadows) return;
    if (this.shadowCount) yield ['mesh', 0, renderer.program('pass_mesh.frag', ['mesh_shadows']), this.shadowValues];
    if (this.ground) yield ['terrain', 0, renderer.program('pass_terrain.frag', [...NOISE, 'terrain']), values];
    for (const { kind, index, settings: own } of this.noiseClouds) {
      const { struct, pass, files } = NOISE_CLOUDS[kind];
      yield [kind, index, renderer.program(pass, files), { ...values, [struct]: { ...own, time: renderer.view.time }, shadow_strength: renderer.scene.shadows.strength }];
    }
  }

  // The name of a target with the shares of the light that come to the places of a layer past those things that count.
  *sharesOf(colors, places, part, counts) {
    const { renderer, size } = this, shares = renderer.target('shares', size, renderer.blendedFormat);
    this.clear(shares, 1, 1, 1, 1);
    const things = [...this.things()].filter(([kind, index]) => counts(kind, index));
    if (!things.length) return shares.name;
    const points = renderer.target('points', size);
    renderer.fill([points], renderer.program('points.frag', ['view']), { ...this.values, colors, places, part });
    for (const [, , program, values] of things) yield* this.banded([shares], program, { ...values, points: points.name }, 'multiply');
    return shares.name;
  }

  // The shadows of the mesh clouds as textures.
  uploadShadows(shadows) {
    const { renderer } = this, { gl } = renderer, depth = Math.max(1, shadows.length);
    this.shadowCount = shadows.length;
    const width = Math.max(1, ...shadows.map(shadow => shadow.width + 1)), height = Math.max(1, ...shadows.map(shadow => shadow.height + 1));
    const sums = new Float32Array(width * height * depth), frames = new Float32Array(6 * 4 * depth);
    for (const [index, shadow] of shadows.entries()) {
      for (let y = 0; y <= shadow.height; ++y)
        sums.set(shadow.sums.subarray(y * (shadow.width + 1), (y + 1) * (shadow.width + 1)), (index * height + y) * width);
      frames.set(shadow.frame(), 24 * index);
    }
    renderer.upload('shadow sums', gl.TEXTURE_2D_ARRAY, { width, height, depth }, gl.R32F, gl.RED, sums);
    renderer.upload('shadow frames', gl.TEXTURE_2D, { width: 6, height: depth }, gl.RGBA32F, gl.RGBA, frames);
  }

  get shadowValues() { return { shadow_sums: 'shadow sums', shadow_frames: 'shadow frames', shadow_count: this.shadowCount }; }

  // What comes of the light to each vertex past ground and clouds of noise; null if there is nothing in its way.
  sharesOfVertices(positions) {
    const { renderer } = this, { gl } = renderer, things = [...this.things()].filter(([kind]) => kind !== 'mesh'), vertices = positions.length / 3;
    if (!things.length || !vertices) return null;
    const width = Math.min(1024, vertices), size = { width, height: Math.ceil(vertices / width) }, points = new Float32Array(4 * size.width * size.height);
    for (let v = 0; v < vertices; ++v) points.set([positions[3 * v], positions[3 * v + 1], positions[3 * v + 2], 1], 4 * v);
    renderer.upload('vertex points', gl.TEXTURE_2D, size, gl.RGBA32F, gl.RGBA, points);
    const shares = renderer.target('vertex shares', size, renderer.blendedFormat);
    this.clear(shares, 1, 1, 1, 1);
    for (const [, , program, values] of things) renderer.multiply([shares], program, { ...values, points: 'vertex points' });
    const found = new Float32Array(points.length);
    renderer.drawTo([shares]);
    gl.readPixels(0, 0, size.width, size.height, gl.RGBA, gl.FLOAT, found);
    return Float32Array.from({ length: vertices }, (_, v) => found[4 * v]);
  }

  // --- The picture ---

  // All layers over the sky, then what is done to a drawn picture.
  compose() {
    const { renderer, settings } = this, { scene, view } = renderer;
    renderer.fill([renderer.target('composed')], renderer.program('compose.frag'), {
      background: 'background', has_clouds: renderer.hasClouds, has_ground: !!this.ground, noise_clouds: this.noiseClouds.length, samples_per_side: this.samplesPerSide,
      cloud_colors: renderer.hasClouds ? 'cloud colors' : 'nothing', cloud_places: renderer.hasClouds ? 'cloud places' : 'nothing',
      ground_colors: this.ground ? 'ground colors' : 'nothing', ground_places: this.ground ? 'ground places' : 'nothing',
      part_colors: 'part colors', part_places: 'part places', fog_density: scene.distance_fog * view.fog, fog_color: view.fog_color,
    });
    this.isComposed = true;
  }

  // What is done to the composed picture, up to the canvas.
  show() {
    const { renderer, settings: { grade } } = this, { view } = renderer, values = { ...view, composed: 'composed', developed: 'developed', sqrt_gamma: grade.sqrt_gamma };
    renderer.fill([renderer.target('developed')], renderer.program('develop.frag', ['tone']), values);
    if (grade.motion_blur && view.was) {
      const { eye, right, up, forward } = view.was, { motion_taps, motion_limit } = grade.motion_blur;
      renderer.fill([renderer.target('blurred')], renderer.program('motion.frag', ['view']), { ...values, was_eye: eye, was_right: right, was_up: up, was_forward: forward, motion_taps, motion_limit });
      values.developed = 'blurred';
    }
    renderer.fill([], renderer.program('grade.frag', ['tone', 'grade']), {
      ...values, has_vignette: !!grade.vignette, vignette: grade.vignette ?? { vignette: 1, vignette_exponent: 1 },
      has_contrast: !!grade.contrast, contrast: grade.contrast ?? { contrast: 0, lift: [0, 0, 0] },
    });
  }
}
