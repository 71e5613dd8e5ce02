// The sequence of a GLB that is dropped on the page (docs/sequences.md), as a scene shows it.

import {
  CURE, boundsOf, keysOfPicture, keysOfTargets, pictureView, pixelsOfPng, primitiveOf, sequenceOf,
} from '../engines/npm/sequence.js';
import { readySequence } from './sequences.js';

/** The bytes of the picture that has the keys. @param {import('./glb.js').GlbReader} reader */
function keyPicture({ json, buffer, binary }) {
  const { byteOffset = 0, byteLength } = json.bufferViews?.[pictureView(json)] ?? {};
  if (!(byteLength > 0)) throw new Error(`the sequence has lost the picture of its keys: ${CURE}`);
  return new Uint8Array(buffer.slice(binary + byteOffset, binary + byteOffset + byteLength));
}

function readSegment(reader, segment, sequence, picture) {
  const { attributes, indices, targets } = primitiveOf(reader.json, sequence.form, segment);
  const keyOf = sets => {
    const numbers = set => reader.read(sets[set], set);
    return { positions: numbers('POSITION'), normals: numbers('NORMAL'), first: numbers('TEXCOORD_0'), second: numbers('TEXCOORD_1') };
  };
  const base = keyOf(attributes), triangles = reader.read(indices, 'triangles'), vertices = base.positions.length / 3;
  if (!triangles.every(v => v < vertices)) throw new Error('The GLB is damaged: a triangle uses a vertex that does not exist.');
  const keys = picture ? keysOfPicture(picture, sequence, segment, vertices) : keysOfTargets(base, targets.map(keyOf));
  return { triangles, keys };
}

/**
 * A scene's mesh of the sequence of a file, which has room for all segments, and the box of all keys. Null for another file.
 * @param {import('./glb.js').GlbReader} reader
 */
export async function sequenceMesh(reader) {
  const sequence = sequenceOf(reader.json);
  if (!sequence) return null;
  const picture = sequence.form === 'picture' ? await pixelsOfPng(keyPicture(reader)) : null;
  const ready = readySequence(sequence, sequence.segments.map(segment => readSegment(reader, segment, sequence, picture)));
  const most = sizeOf => Math.max(...ready.segments.map(sizeOf)), none = new Float32Array(0);
  const vertices = most(({ key }) => key.positions.length / 3), corners = most(({ triangles }) => triangles.length);
  const [low, high] = boundsOf(ready.segments.flatMap(({ keys }) => keys));
  return {
    vertices, corners, low, high, harmonicsPerVertex: 0, room: corners, sequence: { of: 0, by: [1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0] },
    arrays: {
      positions: new Float32Array(3 * vertices), normals: new Float32Array(3 * vertices), lobes: new Float32Array(4 * vertices),
      harmonics: none, colors: none, compared: none, harmonicsPerVertex: 0, triangles: new Uint32Array(corners), sequences: [ready],
    },
  };
}
