// What the materials need to know about an asset. `cloudbake shader npm ASSET.glb` fills in the asset's own numbers.
export const DEFAULTS = {
  exponent: @exponent@,
  bias: @bias@,
  extinction: @extinction@,
  densityMax: @density_max@,
  uvSets: [@first_set@, @second_set@],
};

// The light and the sky of a day, or of a scene, linear. `phase` has no effect until its share is over 0.
export const DAY = {
  sunDirection: [@sun_direction@],
  sunColor: [@sky_colors_sun@],
  ambientSky: [@sky_colors_ambient_sky@],
  ambientGround: [@sky_colors_ambient_ground@],
  phase: { share: 0, asymmetry: @light_phase_asymmetry@, limit: @light_phase_limit@ },
  zenith: [@sky_colors_zenith@],
  lowSky: [@sky_colors_low_sky@],
  horizon: [@sky_colors_horizon@],
  ground: [@sky_colors_ground@],
};

// The settings of a material that is given none. `colorOf` makes a colour of the engine from three numbers.
export const sunDefaults = colorOf => ({ sunLight: null, sunColor: colorOf(DAY.sunColor), exposure: 1 });
// The colours of the sky: settings, and the uniforms that have them.
export const SKY = { zenith: 'zenith', lowSky: 'low_sky', horizon: 'horizon', ground: 'ground' };
export const skyDefaults = colorOf => Object.fromEntries(Object.keys(SKY).map(name => [name, colorOf(DAY[name])]));
export const cloudDefaults = colorOf => ({
  ...DEFAULTS, ambientSky: colorOf(DAY.ambientSky), ambientGround: colorOf(DAY.ambientGround), halfLambert: 0.5, phase: {}, flipV: false,
  ofVolume: false, harmonicOrder: 0, harmonicExtinction: DEFAULTS.extinction,
  rimFrequency: 8, rimScroll: [0, 0, 0], insideLight: 0.7, ditherShift: 0, depthTexture: null, lamps: [],
});

// The settings of an impostor's material that is given none.
export const impostorDefaults = colorOf => ({
  ambientSky: colorOf(DAY.ambientSky), ambientGround: colorOf(DAY.ambientGround), exponent: DEFAULTS.exponent,
  extinction: DEFAULTS.extinction, ofVolume: false, volumeGain: 1, phase: {}, center: [0, 0, 0], radius: 1, atlas: [2, 4, 0, 1],
  lobeTexture: null, restTexture: null,
});

// A number of the asset. Shaders have 32 bits for it, JSON has more.
function constantOf(info, key) {
  const value = info[key] ?? DEFAULTS[key];
  if (typeof value !== 'number' || !Number.isFinite(Math.fround(value)))
    throw new Error(`asset.extras.cloudbake.${key} is ${JSON.stringify(value)}, not a finite number in 32 bits: bake the asset again`);
  return value;
}

// The order of the file's harmonics, 0 without any.
function orderOf({ harmonic_order: order = 0 }) {
  if (![0, 1, 2, 3].includes(order))
    throw new Error(`asset.extras.cloudbake.harmonic_order is ${JSON.stringify(order)}, not a whole number up to 3: bake the asset again`);
  return order;
}

// The largest d of a packed asset, 0 of another one. A layout of a later version is refused.
function densityMaxOf({ layout = 'lobe-uv', version = 1, density_max = 0 }, sequences) {
  if (layout === 'lobe-sequence' && !sequences) throw new Error('the file is a sequence, which CloudSequence plays');
  if (!['lobe-uv', 'lobe-packed', 'lobe-sequence'].includes(layout) || version !== 1)
    throw new Error(`asset.extras.cloudbake has the layout ${layout} ${version}, which this version does not know: bake the asset again`);
  const value = layout === 'lobe-packed' ? density_max : 0;
  if (typeof value !== 'number' || !Number.isFinite(Math.fround(value)) || (layout === 'lobe-packed' && !(value > 0)))
    throw new Error(`asset.extras.cloudbake.density_max is ${JSON.stringify(value)}, not a number above 0: bake the asset again`);
  return value;
}

// The same as DEFAULTS from the JSON of a glTF file, and its harmonics, or null if cloudbake did not bake it. Throws if a number cannot be
// used, and of a sequence unless it is asked for.
export function settingsOf(json, { sequences = false } = {}) {
  const info = json.asset?.extras?.cloudbake;
  if (!info || info.layout === 'lobe-impostor') return null;
  const given = constantOf(info, 'extinction'), extinction = given > 0 ? given : DEFAULTS.extinction;
  return {
    exponent: constantOf(info, 'exponent'),
    bias: constantOf(info, 'bias'),
    extinction,
    densityMax: densityMaxOf(info, sequences),
    uvSets: info.uv_sets ?? DEFAULTS.uvSets,
    ofVolume: info.fit_to === 'volume',
    harmonicOrder: orderOf(info),
    harmonicExtinction: extinction,
  };
}

// Of a lobe impostor (`cloudbake impostor`): what its material needs from the JSON of the file, with the numbers of the textures of its
// atlas; null of another file.
export function impostorSettingsOf(json) {
  const info = json.asset?.extras?.cloudbake;
  if (info?.layout !== 'lobe-impostor') return null;
  if (info.version !== 1)
    throw new Error(`the impostor has version ${info.version} of its layout, not 1: take the package of its cloudbake`);
  const textureOf = name => json.textures?.findIndex(({ source }) => json.images?.[source]?.name === name) ?? -1;
  const lobe = textureOf('lobe'), rest = textureOf('rest');
  if (lobe < 0 || rest < 0)
    throw new Error('the impostor has lost the pictures of its atlas: take the file that `cloudbake impostor` wrote');
  return {
    exponent: constantOf(info, 'exponent'), extinction: constantOf(info, 'extinction'), ofVolume: info.gains === true,
    center: info.center, radius: info.radius, atlas: [info.views, info.frame, lastLevelOf(info.frame), info.thickest],
    textures: { lobe, rest },
  };
}

// Of the mip levels of an atlas: down to 4 pixels to a side of a frame.
function lastLevelOf(frame) {
  let level = 0;
  for (let side = frame; side % 2 === 0 && side >= 8; side /= 2) ++level;
  return level;
}

// The most pixels that the longest side of the full asset may cover where a file of a level (`bake --lods`) is drawn; 0 for the full asset.
export const switchPixelsOf = json => json.asset?.extras?.cloudbake?.switch_pixels ?? 0;

// The frame of a shadow's picture, from the JSON beside it: the values of the uniforms that shaders.js names.
export function shadowValues({ origin, right, up, to_sun, width, height, top = 0, bottom = 0 }, strength) {
  return { shadow_origin: origin, shadow_right: right.map(x => x / width), shadow_up: up.map(x => x / height), shadow_to_sun: to_sun,
    shadow_share: [strength, top, bottom] };
}

// The settings of the soft look, which a material has without passes after the clouds, when each is off.
const SOFT = { rimStart: 0, rimEnd: 0, softDistance: 0, nearFade: [0, 0], farFade: [0, 0] };

// Gives them to a class of materials. A material becomes `soft` by the first one that is not off: only then its shader leaves out pixels,
// which costs graphics cards the early test of depth.
export function addSoftSettings(Material) {
  for (const [name, off] of Object.entries(SOFT))
    Object.defineProperty(Material.prototype, name, {
      get() { return this.softSettings?.[name] ?? off; },
      set(value) {
        this.softSettings = { ...this.softSettings, [name]: value };
        if (String(value) !== String(off)) this.soft = true;
      },
    });
}
export const SOFT_NAMES = Object.keys(SOFT);
export const isSoftened = material => SOFT_NAMES.some(name => String(material[name]) !== String(SOFT[name]));

// The uniforms of the soft look. `painted`: what the painted look needs while it draws, or null. `shown`: from and to which threshold the
// mesh is drawn.
export const softValues = (material, painted, shown = [0, 1]) => ({
  rim: painted ? [0, 0] : [material.rimStart, material.rimEnd],
  near_fade: painted ? painted.nearFade : material.nearFade,
  far_fade: painted ? [0, 0] : material.farFade,
  soft_distance: painted ? 0 : material.softDistance,
  rim_frequency: material.rimFrequency, rim_scroll: material.rimScroll, inside_light: material.insideLight,
  dither_shift: painted ? painted.shift : material.ditherShift, shown,
});
