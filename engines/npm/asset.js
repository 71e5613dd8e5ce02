// What the materials need to know about an asset. `cloudbake shader npm ASSET.glb` fills in the asset's own numbers.
export const DEFAULTS = {
  exponent: @exponent@,
  bias: @bias@,
  extinction: @extinction@,
  uvSets: [@first_set@, @second_set@],
};

// The light and the sky of a day, linear. `phase` has no effect until its share is over 0.
export const DAY = {
  sunDirection: [0.8365163, 0.5, -0.2241439],
  sunColor: [1.1, 0.974, 0.786],
  ambientSky: [0.162, 0.253, 0.48],
  ambientGround: [0.0717, 0.0999, 0.149],
  phase: { share: 0, asymmetry: 0.7, limit: 6 },
  zenith: [0.0194, 0.0434, 0.168],
  lowSky: [0.16, 0.329, 1.43],
  horizon: [1.71, 2.06, 2.07],
  ground: [0.241, 0.38, 0.501],
};

// The settings of a material that is given none. `colorOf` makes a colour of the engine from three numbers.
export const sunDefaults = colorOf => ({ sunLight: null, sunColor: colorOf(DAY.sunColor), exposure: 1 });
const SKY = ['zenith', 'lowSky', 'horizon', 'ground'];
export const skyDefaults = colorOf => Object.fromEntries(SKY.map(name => [name, colorOf(DAY[name])]));
export const cloudDefaults = colorOf => ({
  ...DEFAULTS, ambientSky: colorOf(DAY.ambientSky), ambientGround: colorOf(DAY.ambientGround), halfLambert: 0.5, phase: {}, flipV: false,
});

// A number of the asset. Shaders have 32 bits for it, JSON has more.
function constantOf(info, key) {
  const value = info[key] ?? DEFAULTS[key];
  if (typeof value !== 'number' || !Number.isFinite(Math.fround(value)))
    throw new Error(`asset.extras.cloudbake.${key} is ${JSON.stringify(value)}, not a finite number in 32 bits: bake the asset again`);
  return value;
}

// The same as DEFAULTS from the JSON of a glTF file, or null if cloudbake did not bake it. Throws if a number cannot be used.
export function settingsOf(json) {
  const info = json.asset?.extras?.cloudbake;
  if (!info) return null;
  const extinction = constantOf(info, 'extinction');
  return {
    exponent: constantOf(info, 'exponent'),
    bias: constantOf(info, 'bias'),
    extinction: extinction > 0 ? extinction : DEFAULTS.extinction,
    uvSets: info.uv_sets ?? DEFAULTS.uvSets,
  };
}
