// Reads and writes GLBs: the JSON, and the bytes of the binary chunk.

const GLTF = 0x46546C67, JSON_CHUNK = 0x4E4F534A, BINARY_CHUNK = 0x004E4942;

export function chunksOf(glb) {
  const bytes = Buffer.from(glb.buffer, glb.byteOffset, glb.length), json_end = 20 + bytes.readUInt32LE(12);
  if (bytes.readUInt32LE(0) !== GLTF || bytes.readUInt32LE(8) !== bytes.length) throw new Error('not a GLB');
  return { json: JSON.parse(bytes.toString('utf8', 20, json_end)), binary: bytes.subarray(json_end + 8) };
}

export function glbOf({ json, binary }) {
  const padded = (bytes, filler) => Buffer.concat([bytes, Buffer.alloc(-bytes.length & 3, filler)]);
  const text = padded(Buffer.from(JSON.stringify(json)), ' '), data = padded(binary, 0);
  const words = (...all) => Buffer.from(new Uint32Array(all).buffer);
  return Buffer.concat([words(GLTF, 2, 28 + text.length + data.length, text.length, JSON_CHUNK), text,
    words(data.length, BINARY_CHUNK), data]);
}

// A GLB after change(json).
export function changedGlb(glb, change) {
  const chunks = chunksOf(glb);
  change(chunks.json);
  return glbOf(chunks);
}

// A GLB whose coefficients of harmonics beyond an order are 0.
export function cutHarmonics(glb, order) {
  const { json, binary } = chunksOf(glb), changed = Buffer.from(binary);
  for (const { attributes } of json.meshes.flatMap(({ primitives }) => primitives))
    for (let i = (order + 1) ** 2, index; (index = attributes[`_TRANSMITTANCE_SH_${i >> 2}`]) !== undefined; ++i) {
      const { bufferView, byteOffset = 0, count } = json.accessors[index];
      const { byteOffset: first = 0, byteStride = 16 } = json.bufferViews[bufferView];
      for (let v = 0; v < count; ++v) changed.writeFloatLE(0, first + byteOffset + v * byteStride + 4 * (i & 3));
    }
  return glbOf({ json, binary: changed });
}

const WIDTHS = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4 };
const READERS = { 5120: ['readInt8', 1], 5122: ['readInt16LE', 2], 5121: ['readUInt8', 1], 5123: ['readUInt16LE', 2],
  5125: ['readUInt32LE', 4], 5126: ['readFloatLE', 4] };

// The numbers of an accessor.
export function valuesOf({ json, binary }, index) {
  const { bufferView, byteOffset = 0, componentType, count, type } = json.accessors[index], view = json.bufferViews[bufferView];
  const width = WIDTHS[type], [read, bytes] = READERS[componentType], stride = view.byteStride ?? width * bytes;
  const values = new Float64Array(count * width), first = (view.byteOffset ?? 0) + byteOffset;
  for (let i = 0; i < count; ++i) for (let k = 0; k < width; ++k) values[i * width + k] = binary[read](first + i * stride + k * bytes);
  return values;
}
