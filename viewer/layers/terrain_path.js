// The camera's path over the terrain: terrainPath of preview/backdrop/terrain.h. Only its own place needs the ground's height here.

import { add, clamp, directionFromAngles } from '../vectors.js';

function mixBits(x) {
  x = Math.imul(x ^ (x >>> 16), 0x7feb352d);
  x = Math.imul(x ^ (x >>> 15), 0x846ca68b);
  return (x ^ (x >>> 16)) >>> 0;
}

const hashAlong = (hash, coordinate) => mixBits(hash ^ (Math.imul(coordinate, 0x9E3779B9) + 0x7F4A7C15));
const unitFloat = hash => (hash >>> 8) / 0x1000000;

/** Value noise and its gradient. @param {number[]} place */
function valueNoise2([x, y], seed) {
  const axis = at => {
    const cell = Math.floor(at), t = at - cell;
    return { cell, weight: t * t * t * (t * (6 * t - 15) + 10), slope: 30 * t * t * (t - 1) * (t - 1) };
  };
  const along_x = axis(x), along_y = axis(y), hash = mixBits(seed), [low, high] = [0, 1].map(i => hashAlong(hash, along_y.cell + i));
  const [h00, h10, h01, h11] = [low, low, high, high].map((row, i) => unitFloat(hashAlong(row, along_x.cell + i % 2)));
  const b = h10 - h00, c = h01 - h00, d = h00 - h10 - h01 + h11;
  const value = h00 + b * along_x.weight + c * along_y.weight + d * along_x.weight * along_y.weight;
  return [value, along_x.slope * (b + d * along_y.weight), along_y.slope * (c + d * along_x.weight)];
}

function terrainHeight(x, z, octaves, { scale, origin, seed, shape }) {
  const per_unit = shape.frequency / scale;
  let p = [(x - origin[0]) * per_unit, (z - origin[2]) * per_unit], sum = 0, weight = 1, slope = [0, 0];
  for (let i = 0; i < octaves; ++i) {
    const [value, ...gradient] = valueNoise2(p, (seed + Math.imul(i, 0x632BE5AB)) >>> 0);
    slope = add(slope, gradient);
    sum += weight * value / (1 + slope[0] * slope[0] + slope[1] * slope[1]);
    p = [shape.lacunarity * (0.8 * p[0] - 0.6 * p[1]), shape.lacunarity * (0.6 * p[0] + 0.8 * p[1])];
    weight *= shape.gain;
  }
  return origin[1] + scale * shape.amplitude * sum;
}

// Where the camera is after so many seconds, turned by angles in degrees from where it looks.
export function cameraOnPath(time, terrain, turned) {
  const [turn, lift] = turned, { scale, origin, shape, path } = terrain, t = path.time_factor * time, radius = path.radius * scale;
  const level = at => [origin[0] + radius * Math.cos(path.x_rate * at), 0, origin[2] + radius * Math.cos(path.z_phase + path.z_rate * at)];
  const here = level(t), there = level(t + path.look_ahead);
  const height = terrainHeight(here[0], here[2], shape.camera_octaves, terrain) + path.clearance * scale;
  const from = [here[0], height, here[2]], ahead = add([there[0], height - path.sink * scale, there[2]], from, -1);
  const distance = Math.hypot(...ahead);
  const azimuth = Math.atan2(ahead[0], ahead[2]) * 180 / Math.PI, elevation = Math.asin(ahead[1] / distance) * 180 / Math.PI;
  return {
    from, at: add(from, directionFromAngles(azimuth + turn, clamp(elevation + lift, -89, 89)), distance),
    fov: 2 * Math.atan(1 / path.focal_length) * 180 / Math.PI, roll: path.roll * Math.cos(path.roll_rate * t), distance,
  };
}
