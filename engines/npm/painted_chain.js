// What the painted looks for three.js and Babylon.js share: the settings, and the steps with their values. Each engine draws samples of the
// clouds, and fills its images: `fill(target, step, values)` writes every pixel of an image by a step of painted_shaders.js, where images
// are given by their names.

// The images of four floats. The first one also needs depth for the clouds that are drawn to it.
export const IMAGES = ['sample', 'rows', 'boxes', 'drawn', 'even', 'odd'];

// Those settings that are groups. `cloudbake shader npm --scene` fills in those of a scene.
const GROUPS = {
  softening: { near: @chain_near_width@, far: @chain_far_width@ },
  swirl: { tileSize: @chain_tile_size@, farTiles: @chain_far_tiles@, strength: @chain_swirl_strength@,
    farStrength: @chain_far_strength@, speed: @chain_swirl_speed@, nearDrift: [@chain_near_drift@],
    farDrift: [@chain_far_drift@], dark: @chain_dark@, seed: @chain_seed@ },
  erosion: { shrink: @chain_detail_shrink@, darkening: @chain_detail_darkening@, cell: @chain_detail_size@, seed: @chain_seed@ },
  phase: { share: @light_phase@, asymmetry: @light_phase_asymmetry@, limit: @light_phase_limit@ },
};

const SWIRL_NOISE = { octaves: @swirl_octaves@, gain: @swirl_gain@, cells: @swirl_cells@, typical_slope: @swirl_slope@ };
const EROSION_NOISE = { octaves: @erosion_octaves@, gain: @erosion_gain@, fading: [@erosion_fading@] };
const FAR_SIZES = @far_sizes@;  // the depth is 1 at so many sizes of the clouds

// The samples of a pixel, from its upper left corner.
const placesOf = side => Array.from({ length: side * side }, (_, i) => {
  const column = i % side, row = Math.floor(i / side);
  return [(column + (row + 0.5) / side) / side, (row + (column + 0.5) / side) / side];
});

// The two phases of the swirls, and the weight of the second.
function phasesAt(time, speed) {
  const cycles = time * speed, first = cycles - Math.floor(cycles);
  return [first, (first + 0.5) % 1, Math.abs(2 * first - 1)];
}

// How far the near and the far noise of the swirls have moved, in tiles of their own.
function driftAt(time, { speed, nearDrift, farDrift, farTiles }) {
  const moved = [...nearDrift, ...farDrift.map(tiles => tiles * farTiles)].map(tiles => time * speed * tiles);
  return moved.map(tiles => tiles - Math.floor(tiles));
}

// The settings, of groups what differs from these. `colorOf` makes a colour of the engine from three numbers.
/** @param {any} settings */
export function paintedDefaults(settings, colorOf) {
  const { phase, softening, swirl, erosion, ...others } = settings;
  return {
    time: 0, resolution: 1, samplesPerSide: 2, halfLambert: @light_half_lambert@, volumeGain: @light_volume_gain@,
    depthSpread: @chain_depth_spread@, size: null, nearDistance: @chain_near_distance@, farDistance: Math.max(@chain_far_distance@) || null,
    softDistance: 0, nearFade: [0, 0], farFade: [0, 0], exposure: @picture_exposure@, fogDensity: @fog_density@,
    distanceFog: @fog_per_unit@, fogColor: colorOf([@fog_color@]),
    phase: { ...GROUPS.phase, ...phase }, softening: { ...GROUPS.softening, ...softening },
    swirl: { ...GROUPS.swirl, ...swirl }, erosion: { ...GROUPS.erosion, ...erosion }, ...others,
  };
}

// The pixels of a side of the images, for those of the picture.
export const sideOf = ({ resolution }, side) => Math.max(1, Math.round(resolution * side));

// The uniforms that are the same in all steps, for images of a size. `view`: eye, right, up and forward in the axes of glTF, `tangent` of
// half of the angle of view upwards, and where the noise begins.
export function sceneValues({ erosion, nearDistance, farDistance, size, time, swirl }, { tangent, origin, ...view },
  /** @type {number[]} */ [width, height]) {
  return {
    ...view, picture: [width, height], per_pixel: 2 * tangent / height, mean_all: false,
    depth_range: [nearDistance, farDistance ?? nearDistance + FAR_SIZES * size], phases: phasesAt(time, swirl.speed),
    drift: driftAt(time, swirl), noise_origin: origin, noise_size: erosion.cell * size,
  };
}

// The mean of the samples of each pixel, in the image `drawn`. `drawSample(place, shift)` draws the channels of the nearest clouds at a
// place of each pixel, from its upper left corner, in units of its side; `shift` is added to the thresholds by which they fade.
export function drawSamples({ samplesPerSide }, fill, clear, drawSample) {
  const places = placesOf(samplesPerSide);
  let [sums, next] = ['rows', 'boxes'];
  clear(sums);
  places.forEach((place, i) => {
    drawSample(place, i / places.length);
    fill(next, 'accumulate', { sums, samples: 'sample', share: 1 / places.length, fineness: 1, pixel: [0, 0] });
    [sums, next] = [next, sums];
  });
  fill('drawn', 'mean', { sums, share: 1 });
}

// The steps of preview/mesh_clouds/ for images of a height. The name of the image that they end in.
export function paint({ depthSpread, softening, swirl, erosion }, height, fill) {
  // Two boxes, along rows and along columns, into the image `boxes`.
  const boxes = (image, channels, near, far) => {
    const widths = { channels, near_half: near * height, far_half: far * height };
    fill('rows', 'box', { image, axis: [1, 0], ...widths });
    fill('boxes', 'box', { image: 'rows', axis: [0, 1], ...widths });
  };
  fill('odd', 'weighted', { channels: 'drawn', of_depth: true });
  boxes('odd', 'drawn', depthSpread, depthSpread);
  fill('even', 'spread', { channels: 'drawn', weighted: 'boxes' });

  fill('odd', 'weighted', { channels: 'even', of_depth: false });
  boxes('odd', 'even', softening.near, softening.far);
  boxes('boxes', 'even', softening.near, softening.far);
  fill('odd', 'soft', { channels: 'even', weighted: 'boxes' });

  const flow = { tile_size: swirl.tileSize, far_tiles: swirl.farTiles, swirl_strength: swirl.strength, far_strength: swirl.farStrength,
    dark: swirl.dark, seed: swirl.seed };
  fill('even', 'distort', { channels: 'odd', ...SWIRL_NOISE, ...flow });
  fill('odd', 'erode', { channels: 'even', ...EROSION_NOISE, shrink: erosion.shrink, darkening: erosion.darkening, seed: erosion.seed });
  return 'odd';
}

// The uniforms of the last step, for a picture of a size.
export function compositeValues(settings, { tangent }, /** @type {number[]} */ [width, height]) {
  const { phase, exposure, fogDensity, distanceFog, fogColor, softDistance, farFade } = settings;
  return {
    drawn: 'drawn', picture: [width, height], per_pixel: 2 * tangent / height, exposure, fog_density: fogDensity, distance_fog: distanceFog,
    fog_color: fogColor, fog_scatter: [0, 1], phase: [phase.share, phase.asymmetry, phase.limit], soft_distance: softDistance,
    far_fade: farFade,
  };
}
