// Clouds that change (`cloudbake sequence`), for any engine: which segments are seen at a time, their keys, and what is between two keys.
// docs/sequences.md of cloudbake describes the file.

export const CURE = 'take the file that `cloudbake sequence` wrote';
const STEPS = 65535;

const rising = frames => Array.isArray(frames) && frames.length > 0
  && frames.every((frame, i) => Number.isFinite(frame) && frame >= 0 && (i === 0 || frame > frames[i - 1]));

/**
 * A segment: the number of its mesh, the frames of its keys, and in a picture its first row.
 * @typedef {{ mesh: number, frames: number[], firstRow: number }} Segment
 * @typedef {{ form: string, framesPerSecond: number, loops: boolean, period: number, segments: Segment[], box: number[][],
 *   densityMax: number }} Sequence
 * @typedef {{ positions: Float32Array, normals: Float32Array, first: Float32Array, second: Float32Array }} Key the numbers of all vertices:
 *   of `first` and `second` two each, (o.x, o.y) and (o.z, d)
 */

const segmentsAreRight = segments => Array.isArray(segments) && segments.length > 0
  && segments.every(({ frames }, s) => rising(frames) && (s === 0 || frames[0] >= segments[s - 1].frames[0]));
const pictureIsRight = ({ box, density_max }) => box?.length === 2 && box.flat().length === 6 && density_max >= 0;

/** What the JSON of a glTF file says about a sequence; null of another file. @returns {Sequence | null} */
export function sequenceOf(json) {
  const info = json.asset?.extras?.cloudbake;
  if (info?.layout !== 'lobe-sequence') return null;
  if (info.version !== 1)
    throw new Error(`the sequence has version ${info.version} of its layout, not 1: take the package of its cloudbake`);
  const own = info.sequence ?? {}, is_known = own.keys === 'morph targets' || (own.keys === 'picture' && pictureIsRight(own));
  if (!is_known || !(own.frames_per_second > 0) || !(own.period >= 0) || !segmentsAreRight(own.segments))
    throw new Error(`the sequence's metadata are incomplete or damaged: ${CURE}`);
  return { form: own.keys, framesPerSecond: own.frames_per_second, loops: own.loops === true, period: own.period, box: own.box,
    densityMax: own.density_max,
    segments: own.segments.map(({ mesh, frames, first_row }) => ({ mesh, frames, firstRow: first_row })) };
}

/** The number of the buffer view with the picture of the keys. */
export function pictureView(json) {
  const { bufferView } = json.images?.find(({ name }) => name === 'keys') ?? {};
  if (bufferView === undefined) throw new Error(`the sequence has lost the picture of its keys: ${CURE}`);
  return bufferView;
}

/** The primitive of a segment: its first key and, unless there is a picture, the others as morph targets. */
export function primitiveOf(json, form, { mesh, frames }) {
  const primitive = json.meshes?.[mesh]?.primitives[0];
  if (!primitive) throw new Error(`a segment of the sequence has no mesh: ${CURE}`);
  const { attributes, indices, targets = [] } = primitive;
  if (form !== 'picture' && targets.length !== frames.length - 1) throw new Error(`a key of the sequence has no morph target: ${CURE}`);
  return { attributes, indices, targets };
}

/**
 * The segments that are seen at a time, with the frame and the weight of each: one, or two while one fades into the other, the earlier one
 * first. A sequence that does not loop stays at its last frame.
 * @param {Pick<Sequence, 'framesPerSecond' | 'loops' | 'period'> & { segments: { frames: number[] }[] }} sequence @param {number} seconds
 */
export function seenAt({ segments, framesPerSecond, loops, period }, seconds) {
  const first = i => segments[i].frames[0], last = i => segments[i].frames.at(-1), end = segments.length - 1;
  let frame = Math.max(0, seconds * framesPerSecond), now = 0;
  frame = loops && period > 0 ? frame % period : Math.min(frame, last(end));
  // The segment that began last, counting the last one of a loop, which reaches into the first frames.
  while (now < end && first(now + 1) <= frame) ++now;
  let before = null;
  if (now > 0 && last(now - 1) > frame) before = { segment: now - 1, frame };
  else if (now === 0 && loops && last(end) - period > frame) before = { segment: end, frame: frame + period };
  if (!before) return [{ segment: now, frame, weight: 1 }];
  const begin = now > 0 ? first(now) : period, weight = (before.frame - begin) / (last(before.segment) - begin);
  return [{ ...before, weight: 1 - weight }, { segment: now, frame, weight }];
}

/** The segments of the meshes that an engine has: the only segment of a loop, which fades into itself, is there twice. */
export const shownSegments = ({ segments, loops }) => loops && segments.length === 1 ? [segments[0], segments[0]] : segments;

/**
 * Which of these meshes are drawn at a time: their numbers, their frames, and between which thresholds of the dither. In a fade the later
 * one takes the pixels below its weight.
 * @param {Sequence} sequence @param {number} seconds @returns {{ part: number, frame: number, shown: [number, number] }[]}
 */
export function shownAt(sequence, seconds) {
  const seen = seenAt(sequence, seconds).filter(one => one.weight > 0), [{ segment: first }] = seen;
  const { segment, frame, weight } = seen.at(-1);
  /** @type {{ part: number, frame: number, shown: [number, number] }} */
  const later = { part: segment, frame, shown: [0, weight] };
  if (seen.length === 1) return [{ ...later, shown: [0, 1] }];
  return [{ part: first === segment ? 1 : first, frame: seen[0].frame, shown: [weight, 1] }, later];
}

/**
 * The lowest and the highest corner of a box that holds these keys, and so what lies between two of them.
 * @param {Pick<Key, 'positions'>[]} keys
 */
export function boundsOf(keys) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (const { positions } of keys)
    for (let i = 0; i < positions.length; ++i) {
      low[i % 3] = Math.min(low[i % 3], positions[i]);
      high[i % 3] = Math.max(high[i % 3], positions[i]);
    }
  return [low, high];
}

/** @param {number} vertices @returns {Key} */
export const emptyKey = vertices => ({ positions: new Float32Array(3 * vertices), normals: new Float32Array(3 * vertices),
  first: new Float32Array(2 * vertices), second: new Float32Array(2 * vertices) });

// --- Blending ---

function setNormal(normals, i, x, y, z, /** @type {number[]} */ [other_x, other_y, other_z]) {
  const size = Math.sqrt(x * x + y * y + z * z), is_right = size > 0;
  normals[i] = is_right ? x / size : other_x;
  normals[i + 1] = is_right ? y / size : other_y;
  normals[i + 2] = is_right ? z / size : other_z;
}

// The lobe is the vector o * d: o is made unit, and d is multiplied by the length that o had.
function setLobe({ first, second }, i, x, y, z, d) {
  const size = Math.sqrt(x * x + y * y + z * z), factor = size > 0 ? 1 / size : 1;
  first[i] = x * factor;
  first[i + 1] = y * factor;
  second[i] = z * factor;
  second[i + 1] = size > 0 ? d * size : 0;
}

function copyKey(from, out) {
  for (const name of ['positions', 'normals', 'first', 'second']) out[name].set(from[name]);
}

/** Writes what is a share of the way from one key to another. @param {Key} from @param {Key} to @param {number} share @param {Key} out */
export function blendKeys(from, to, share, out) {
  const t = Math.fround(share), mixed = (a, b, i) => a[i] + (b[i] - a[i]) * t;
  if (t === 0 || t === 1) {
    copyKey(t === 0 ? from : to, out);
    return;
  }
  const { positions, normals, first, second } = from, own = [0, 0, 0];
  for (let i = 0; i < positions.length; ++i) out.positions[i] = mixed(positions, to.positions, i);
  for (let i = 0; i < normals.length; i += 3) {
    own[0] = normals[i], own[1] = normals[i + 1], own[2] = normals[i + 2];
    setNormal(out.normals, i, mixed(normals, to.normals, i), mixed(normals, to.normals, i + 1), mixed(normals, to.normals, i + 2), own);
  }
  for (let i = 0; i < first.length; i += 2)
    setLobe(out, i, mixed(first, to.first, i), mixed(first, to.first, i + 1), mixed(second, to.second, i),
      mixed(second, to.second, i + 1));
}

/**
 * Writes the key at a frame, which is clamped to those of the segment.
 * @param {{ frames: number[], keys: Key[] }} segment @param {number} frame @param {Key} out
 */
export function writeKeyAt({ frames, keys }, frame, out) {
  const after = frames.findIndex(other => other >= frame);
  if (after <= 0) copyKey(after === 0 ? keys[0] : keys.at(-1), out);
  else blendKeys(keys[after - 1], keys[after], (frame - frames[after - 1]) / (frames[after] - frames[after - 1]), out);
}

// --- Keys as morph targets ---

const UP = [0, 1, 0];

/**
 * The keys of a segment from its mesh and its morph targets, whose numbers are differences to the mesh.
 * @param {Key} base @param {Key[]} targets @returns {Key[]}
 */
export function keysOfTargets(base, targets) {
  const vertices = base.positions.length / 3, none = emptyKey(vertices);
  return [none, ...targets].map(target => {
    if (target.positions.length !== 3 * vertices) throw new Error(`the keys of a segment have different numbers of vertices: ${CURE}`);
    const key = emptyKey(vertices), sum = (name, i) => Math.fround(base[name][i] + target[name][i]);
    for (let i = 0; i < 3 * vertices; ++i) key.positions[i] = sum('positions', i);
    for (let i = 0; i < 3 * vertices; i += 3)
      setNormal(key.normals, i, sum('normals', i), sum('normals', i + 1), sum('normals', i + 2), UP);
    for (let i = 0; i < 2 * vertices; i += 2)
      setLobe(key, i, sum('first', i), sum('first', i + 1), sum('second', i), sum('second', i + 1));
    return key;
  });
}

// --- Keys in a picture ---

/**
 * The bytes of a PNG, exactly as they are stored: a browser's canvas may change them to protect the privacy of its user.
 * @param {ArrayBuffer | Uint8Array} file
 * @returns {Promise<{ width: number, height: number, channels: number, bytes: Uint8Array }>}
 */
export async function pixelsOfPng(file) {
  const all = new Uint8Array(file), view = new DataView(all.buffer), parts = [];
  let head = null;
  for (let at = 8; at + 12 <= all.length; at += 12 + view.getUint32(at)) {
    const type = String.fromCharCode(...all.subarray(at + 4, at + 8)), data = all.subarray(at + 8, at + 8 + view.getUint32(at));
    if (type === 'IHDR') head = { width: view.getUint32(at + 8), height: view.getUint32(at + 12), kind: data.subarray(8, 13) };
    if (type === 'IDAT') parts.push(data);
  }
  const [depth, color, , , is_interlaced] = head?.kind ?? [], channels = color === 2 ? 3 : 4;
  if (!head || depth !== 8 || ![2, 6].includes(color) || is_interlaced)
    throw new Error(`the picture of the keys is no PNG with three bytes per texel: ${CURE}`);
  const rows = new Uint8Array(await new Response(new Blob(parts).stream().pipeThrough(new DecompressionStream('deflate'))).arrayBuffer());
  const { width, height } = head, stride = width * channels;
  if (rows.length < height * (stride + 1)) throw new Error(`the picture of the keys is damaged: ${CURE}`);
  return { width, height, channels, bytes: unfiltered(rows, height, stride, channels) };
}

// The one of the byte to the left, the one above, and the one above that to the left which is nearest to left + above - corner.
function nearestOf(left, above, corner) {
  const a = Math.abs(above - corner), b = Math.abs(left - corner), c = Math.abs(left + above - 2 * corner);
  return a <= b && a <= c ? left : b <= c ? above : corner;
}

// Each row begins with the number of its filter, and has the differences of its bytes to what the filter expects.
function unfiltered(rows, height, stride, channels) {
  const bytes = new Uint8Array(height * stride);
  let above = new Uint8Array(stride);
  for (let y = 0; y < height; ++y) {
    const begin = y * (stride + 1) + 1, filter = rows[begin - 1], row = bytes.subarray(y * stride, (y + 1) * stride);
    row.set(rows.subarray(begin, begin + stride));
    if (filter > 4) throw new Error(`the picture of the keys is damaged: ${CURE}`);
    if (filter === 1) for (let x = channels; x < stride; ++x) row[x] += row[x - channels];
    if (filter === 2) for (let x = 0; x < stride; ++x) row[x] += above[x];
    if (filter === 3) for (let x = 0; x < stride; ++x) row[x] += (x < channels ? 0 : row[x - channels]) + above[x] >> 1;
    if (filter === 4)
      for (let x = 0; x < stride; ++x)
        row[x] += x < channels ? above[x] : nearestOf(row[x - channels], above[x], above[x - channels]);
    above = row;
  }
  return bytes;
}

let octahedron = null;
/** The directions of the octahedron's map, by the two bytes of a point: three numbers each. @returns {Float32Array} */
export function octahedronOf() {
  if (octahedron) return octahedron;
  octahedron = new Float32Array(3 * 65536);
  for (let i = 0; i < 65536; ++i) {
    const u = (i >> 8) / 127.5 - 1, v = (i & 255) / 127.5 - 1, z = 1 - Math.abs(u) - Math.abs(v), fold = Math.max(-z, 0);
    const x = u - (u < 0 ? -fold : fold), y = v - (v < 0 ? -fold : fold), size = Math.sqrt(x * x + y * y + z * z);
    octahedron[3 * i] = x / size;
    octahedron[3 * i + 1] = y / size;
    octahedron[3 * i + 2] = z / size;
  }
  return octahedron;
}

/**
 * The keys of a segment from the picture.
 * @param {{ width: number, height: number, channels: number, bytes: Uint8Array }} picture @param {Sequence} sequence
 * @param {Segment} segment @param {number} vertices @returns {Key[]}
 */
export function keysOfPicture({ width, height, channels, bytes }, { box: [low, high], densityMax }, { frames, firstRow }, vertices) {
  const columns = 1024, block = Math.ceil(vertices / columns) * frames.length, directions = octahedronOf();
  if (width !== columns || !(firstRow >= 0) || firstRow + 4 * block > height)
    throw new Error(`the picture of the keys has another size: ${CURE}`);
  return frames.map((_, k) => {
    const key = emptyKey(vertices), step = channels * block * columns;
    for (let v = 0; v < vertices; ++v) {
      const row = firstRow + Math.floor(v / columns) * frames.length + k;
      const a = channels * (row * columns + v % columns), b = a + step, c = b + step, d = c + step;
      const lobe = 3 * (256 * bytes[c] + bytes[c + 1]), normal = 3 * (256 * bytes[d] + bytes[d + 1]);
      for (let axis = 0; axis < 3; ++axis) {
        key.positions[3 * v + axis] = low[axis] + (high[axis] - low[axis]) * (256 * bytes[a + axis] + bytes[b + axis]) / STEPS;
        key.normals[3 * v + axis] = directions[normal + axis];
      }
      const root = (256 * bytes[c + 2] + bytes[d + 2]) / STEPS;
      key.first[2 * v] = directions[lobe];
      key.first[2 * v + 1] = directions[lobe + 1];
      key.second[2 * v] = directions[lobe + 2];
      key.second[2 * v + 1] = densityMax * root * root;
    }
    return key;
  });
}
