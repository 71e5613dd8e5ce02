// Clouds that change (docs/sequences.md): which meshes they have at a time, and these meshes in the place of those before. A scene has room
// for the largest of them.

import { emptyKey, seenAt, writeKeyAt } from '../engines/npm/sequence.js';
import { InsideLengths } from './lengths.js';
import { cross, dot } from './vectors.js';
import { VolumeField } from './volume.js';

const CASTER_CELLS = 64;  // along the longest side: kCasterVoxels of pipeline/picture/scene_shadows.h

/** The scene and its fields, where they have clouds that change. @param {Scene} scene */
const changing = scene => [scene, scene.scattered].filter(one => one?.arrays.sequences?.length);

/** Seconds after which a loop repeats; else those of the last frame. */
export const durationOf = ({ period, framesPerSecond }) => period / framesPerSecond;

/**
 * The pictures of a time, with their weights and what is seen of each sequence in them. Where a cloud fades from one mesh to another, there
 * are two, which are blended; the later mesh is in the last one. Clouds that are at the same moment of a fade share them.
 * @param {Scene} scene @param {number} seconds @returns {FadedPicture[]}
 */
export function picturesAt(scene, seconds) {
  const sequences = changing(scene).flatMap(({ arrays }) => arrays.sequences);
  const all = sequences.map(sequence => ({ sequence, segments: seenAt(sequence, seconds) }));
  const shares = new Set(all.filter(({ segments }) => segments.length > 1).map(({ segments: [{ weight }] }) => weight));
  let pictures = [{ weight: 1, seen: new Map() }];
  for (const { sequence, segments } of all) pictures[0].seen.set(sequence, segments.at(-1));
  for (const share of shares)
    pictures = pictures.flatMap(({ weight, seen: later }) => {
      const seen = new Map(later);
      for (const { sequence, segments: [earlier] } of all) if (earlier.weight === share) seen.set(sequence, earlier);
      return [{ weight: share * weight, seen }, { weight: (1 - share) * weight, seen: later }];
    });
  return pictures.filter(({ weight }) => weight > 0);
}

/** The map of a part by columns, what turns normals, and -1 for a mirror. @param {number[]} by 3 × 3 by columns and the offset */
function mapOf(by) {
  const [x, y, z] = [0, 3, 6].map(first => by.slice(first, first + 3)), mirrored = dot(cross(x, y), z) < 0 ? -1 : 1;
  return { by, normals: [cross(y, z), cross(z, x), cross(x, y)].flat().map(value => mirrored * value), mirrored };
}

// Writes a vector that is turned by a map, as a unit vector, and returns how long it was.
function turn(m, x, y, z, target, at) {
  const [a, b, c] = [m[0] * x + m[3] * y + m[6] * z, m[1] * x + m[4] * y + m[7] * z, m[2] * x + m[5] * y + m[8] * z];
  const length = Math.sqrt(a * a + b * b + c * c), factor = length > 0 ? 1 / length : 0;
  target[at] = a * factor;
  target[at + 1] = b * factor;
  target[at + 2] = c * factor;
  return length;
}

// Puts the mesh of a segment into the place of a part.
function putMesh(part, { triangles, key: { positions, normals, first, second } }, arrays) {
  const { by, normals: turned, mirrored } = mapOf(part.sequence.by), { first_vertex } = part, place = arrays.positions;
  part.vertices = positions.length / 3;
  for (let v = 0; v < part.vertices; ++v) {
    const [x, y, z] = [positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]], at = first_vertex + v;
    for (let r = 0; r < 3; ++r) place[3 * at + r] = by[r] * x + by[3 + r] * y + by[6 + r] * z + by[9 + r];
    turn(turned, normals[3 * v], normals[3 * v + 1], normals[3 * v + 2], arrays.normals, 3 * at);
    const stretch = turn(by, first[2 * v], first[2 * v + 1], second[2 * v], arrays.lobes, 4 * at);
    arrays.lobes[4 * at + 3] = second[2 * v + 1] * stretch;
  }
  const begin = part.first, [b, c] = mirrored < 0 ? [2, 1] : [1, 2];
  for (let t = 0; t < triangles.length; t += 3) {
    arrays.triangles[begin + t] = first_vertex + triangles[t];
    arrays.triangles[begin + t + 1] = first_vertex + triangles[t + b];
    arrays.triangles[begin + t + 2] = first_vertex + triangles[t + c];
  }
  arrays.triangles.fill(first_vertex, begin + triangles.length, begin + part.room);  // nothing is drawn of the rest
  part.count = triangles.length;
}

// The segment of a sequence that is seen, with its key at that frame.
function meshAt({ segments }, { segment, frame }) {
  const found = segments[segment];
  writeKeyAt(found, frame, found.key);
  return found;
}

/**
 * Puts the meshes of a picture into the arrays of a scene. Returns whether they are others than before.
 * @param {Scene} scene @param {FadedPicture} picture
 */
export function showMeshes(scene, { seen }) {
  let is_new = false;
  for (const { arrays, arrays: { sequences }, parts } of changing(scene)) {
    const key = JSON.stringify(sequences.map(one => seen.get(one)));
    if (key === arrays.shown) continue;
    arrays.shown = key;
    is_new = true;
    for (const part of parts)
      if (part.sequence) putMesh(part, meshAt(sequences[part.sequence.of], seen.get(sequences[part.sequence.of])), arrays);
  }
  return is_new;
}

/** Gives the clouds of a scene the shadows of their meshes in a picture. @param {Scene} scene @param {FadedPicture} picture */
export function showCasters(scene, { seen }) {
  for (const { arrays, parts, casters } of changing(scene))
    for (const { sequence, caster } of parts) {
      if (!sequence || caster === undefined) continue;
      const one = arrays.sequences[sequence.of], key = JSON.stringify(seen.get(one)), shaded = arrays.shaded ??= {};
      if (key === shaded[caster]) continue;
      shaded[caster] = key;
      const { triangles, key: { positions } } = meshAt(one, seen.get(one));
      const part = { first: 0, count: triangles.length, first_vertex: 0, vertices: positions.length / 3 };
      const { origin, cell_size, cells, fractions } = new VolumeField(new InsideLengths({ positions, triangles }, part), CASTER_CELLS);
      casters[caster] = { origin, cell_size, cells: /** @type {[number, number, number]} */ (cells) };
      arrays.fields[caster] = Uint8Array.from(fractions, share => Math.round(255 * share));
    }
}

/**
 * A sequence that is ready to be shown: its segments get room for what is between two keys.
 * @param {Omit<CloudSequence, 'segments'> & { segments: { frames: number[] }[] }} sequence
 * @param {Pick<SequenceSegment, 'triangles' | 'keys'>[]} meshes of its segments @returns {CloudSequence}
 */
export const readySequence = ({ framesPerSecond, loops, period, segments }, meshes) => ({ framesPerSecond, loops, period,
  segments: segments.map(({ frames }, i) => ({ frames, ...meshes[i], key: emptyKey(meshes[i].keys[0].positions.length / 3) })) });
