// Scene files that have one layer each, and the scenes of data/scenes that the page of `cloudbake view` draws.
export const SIZE = [320, 180];

const PLAIN = '[picture]\ntime = 5\nwidth = 320\nheight = 180\n[camera]\nposition = [0, 1.2, 22]\ntarget = [0, 6.2, 0]\n' +
  'fov = 46\n[sun]\nazimuth = 75\nelevation = 34\n';
const TERRAIN = '[terrain]\nscale = 0.03\norigin = [30, -4.6, 10]\n';
const LAYERS = {
  terrain: TERRAIN,
  own_sky: `${TERRAIN}as_published = true\n`,
  slab: '[[slab]]\nbottom = 9\ncenter = 10\ntop = 13\nnoise_scale = 8\nedge_width = 0.25\nhigh_drift = [0.3, 0.1]\n',
  distance: "[[marched]]\nfield = 'distance'\ncloud_height = 12\nwind = [1, 0, 0]\n",
  density: "[[marched]]\nfield = 'density'\ncloud_height = 13\nopacity_factor = 0.9\nwind = [1, 0, 0]\n",
  night: `[sky]\n[sky.moon]\nazimuth = 190\nelevation = 25\nphase = 40\n[sky.stars]\nbrightness = 2\n${TERRAIN}`,
  twilight: `[[slab]]\nbottom = 9\ncenter = 10\ntop = 13\nnoise_scale = 8\nedge_width = 0.25\nmiddle = [0.5, 0.6, 0.7]\n${TERRAIN}`,
  fog: `${TERRAIN}[fog]\nper_unit = 0.02\nscatter = 0.6\n`,
  smooth_moon: `[sky]\n[sky.moon]\nazimuth = 190\nelevation = 25\nphase = 40\ndisc = 'smooth'\n[sky.stars]\nbrightness = 2\n` +
    `turn = 50\npole = [1, 1, 0]\n${TERRAIN}`,
  moon_picture: `[sky]\n[sky.moon]\nazimuth = 185\nelevation = 17\nphase = 20\ndisc_exponent = 2000\nup = [1, 1, 0]\n` +
    `picture = 'painted.png'\n${TERRAIN}`,
  aurora: `[sky]\n[sky.stars]\n[sky.aurora]\nseed = 2\n${TERRAIN}`,
  ramp: `[sky]\nramp = 'painted.png'\nramp_high = 60\n${TERRAIN}`,
  sunk_horizon: `[sky]\nviewer_height = 0.01\n[[marched]]\ncloud_height = 12\n`,
  dust: `[[cloud]]\nfile = 'dusty.glb'\nposition = [0, 5, 14]\n[[dust]]\nlattice = 'dusty.json'\nposition = [0, 5, 14]\nthickness = 1\n`,
  shade: `${TERRAIN}[[cloud]]\nfile = 'dusty.glb'\nscale = 1.2\n[cloud.scatter]\nlow = [-16, 8, -20]\nhigh = [16, 11, 12]\ncount = 40\n` +
    `size = [0.7, 1.3]\ndrift = [0.5, 0, 0]\n[[cloud]]\nfile = 'dusty.glb'\nposition = [3, 9, 5]\n`,
  smooth_disc: `[sky]\ndisc = 'smooth'\n${TERRAIN}`,
  samples: '[[slab]]\nbottom = 9\ncenter = 10\ntop = 13\nnoise_scale = 8\nsamples_per_side = 2\n',
  grade: `${TERRAIN}[grade]\nvignette = 0.5\ncontrast = 0.4\n`,
  square_root: `${TERRAIN}[grade]\ngamma = 'sqrt'\n`,
};
const SUNS = { night: -20, smooth_moon: -20, moon_picture: -20, aurora: -20, twilight: -3 };  // degrees
const beginning = name => PLAIN.replace('elevation = 34', `elevation = ${SUNS[name] ?? 34}`)
  .replace('time = 5\n', name === 'aurora' ? 'time = 5\ntime_offset = 3\n' : 'time = 5\n');

// The text of each scene file by its name.
export const LAYER_SCENES = Object.fromEntries(Object.entries(LAYERS).map(([name, text]) =>
  [name, `${beginning(name)}${text}[light]\nshadows = true\n${name === 'shade' ? 'cloud_shade = "grid"\n' : ''}`]));

export const SCENES = ['dawn_terrain', 'dusk_moon', 'flight', 'sea_noon', 'storm', 'toon'];

// Makes the files that some of them name, with a function that runs the program in their folder.
export function makeFiles(run) {
  run('grow', 'puffball', '--voxels', '40', '--rays', '64', '--basis', 'sh3', '--lattice', 'dusty.json', '-o', 'dusty.glb');
  run('preview', 'dusty.glb', '--size', '60x48', '-o', 'painted.png');
}
