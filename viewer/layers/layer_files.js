// The files of functions that the shaders of layers use.

export const NOISE = ['noise', 'shading'];

// How a march through clouds writes what it has found.
export const MARCH = ['cuts', 'parts'];

export const SKY_FILES = [...NOISE, 'sky', 'night', 'view', 'sky_uniforms', 'night_sky'];

const MARCHED = [...NOISE, 'random', 'samples', 'marched'];

// The clouds of noise by kind: the name of their settings, the pass of their shadows, and the files of both. Dust neither casts a shadow
// nor receives one but that of its own lattice.
export const NOISE_CLOUDS = {
  slabs: { struct: 'slab', pass: 'pass_slab.frag', files: [...NOISE, 'random', 'samples', 'slab'] },
  distance: { struct: 'marched', pass: 'pass_marched.frag', files: [...MARCHED, 'distance_clouds'] },
  density: { struct: 'marched', pass: 'pass_marched.frag', files: [...MARCHED, 'density_clouds'] },
  dust: { struct: 'dust', pass: null, files: [...NOISE, 'random', 'samples', 'light', 'dust'] },
};
