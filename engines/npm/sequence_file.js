// The GLB of a sequence, for engines whose loaders do not hand over its keys.
import { CURE, keysOfPicture, keysOfTargets, pictureView, pixelsOfPng, primitiveOf, sequenceOf } from './sequence.js';

const ARRAYS = { 5123: Uint16Array, 5125: Uint32Array, 5126: Float32Array }, WIDTHS = { SCALAR: 1, VEC2: 2, VEC3: 3 };
const SETS = { positions: 'POSITION', normals: 'NORMAL', first: 'TEXCOORD_0', second: 'TEXCOORD_1' };

/** The JSON and the bytes of the binary chunk. @param {ArrayBuffer} file */
function chunksOf(file) {
  const view = new DataView(file), size = file.byteLength >= 28 && view.getUint32(0, true) === 0x46546C67 ? view.getUint32(12, true) : -1;
  if (size < 0 || 28 + size > file.byteLength) throw new Error(`the sequence is no GLB, or a damaged one: ${CURE}`);
  return { json: JSON.parse(new TextDecoder().decode(new Uint8Array(file, 20, size))), binary: new Uint8Array(file, 28 + size) };
}

function bytesOf({ json, binary }, number) {
  const { byteOffset = 0, byteLength } = json.bufferViews[number];
  return binary.slice(byteOffset, byteOffset + byteLength);
}

// The numbers of an accessor. They follow each other in the files of cloudbake.
function numbersOf(chunks, number) {
  const accessor = chunks.json.accessors?.[number], Numbers = ARRAYS[accessor?.componentType], { byteOffset = 0 } = accessor ?? {};
  if (!Numbers || accessor.bufferView === undefined || chunks.json.bufferViews[accessor.bufferView].byteStride)
    throw new Error(`the sequence's numbers are stored in another way: ${CURE}`);
  return new Numbers(bytesOf(chunks, accessor.bufferView).buffer, byteOffset, accessor.count * WIDTHS[accessor.type]);
}

// The numbers of the attributes of a primitive or of one of its morph targets.
function keyOf(chunks, attributes) {
  return /** @type {import('./sequence.js').Key} */ (Object.fromEntries(Object.entries(SETS).map(([name, set]) => {
    if (attributes[set] === undefined) throw new Error(`a key of the sequence has no ${set}: ${CURE}`);
    return [name, numbersOf(chunks, attributes[set])];
  })));
}

/** What the file says, and its segments with their keys and triangles. @param {ArrayBuffer} file */
export async function readSequence(file) {
  const chunks = chunksOf(file), { json } = chunks, sequence = sequenceOf(json);
  if (!sequence) throw new Error('the file is no sequence: make one with `cloudbake sequence`');
  const picture = sequence.form === 'picture' ? await pixelsOfPng(bytesOf(chunks, pictureView(json))) : null;
  const segments = sequence.segments.map(segment => {
    const { attributes, indices, targets } = primitiveOf(json, sequence.form, segment), base = keyOf(chunks, attributes);
    const keys = picture ? keysOfPicture(picture, sequence, segment, base.positions.length / 3)
      : keysOfTargets(base, targets.map(target => keyOf(chunks, target)));
    return { ...segment, keys, index: numbersOf(chunks, indices) };
  });
  return { json, sequence: { ...sequence, segments } };
}
