// Clouds that change (`cloudbake sequence`), in three.js.
import { Box3, BufferAttribute, BufferGeometry, DynamicDrawUsage, Group, Mesh, Sphere, Vector3 } from 'three';
import { settingsOf } from './asset.js';
import {
  CURE, emptyKey, keysOfPicture, keysOfTargets, pictureView, pixelsOfPng, primitiveOf, sequenceOf, shownAt, shownSegments, writeKeyAt,
} from './sequence.js';
import { setFading } from './sequence_fade.js';
import { CloudMaterial } from './three.js';

// The names of the numbers of a key in a mesh of three.js, in a file, and how many a vertex has.
/** @type {[string, string, string, number][]} */
const ATTRIBUTES = [['positions', 'position', 'POSITION', 3], ['normals', 'normal', 'NORMAL', 3], ['first', 'uv', 'TEXCOORD_0', 2],
  ['second', 'uv1', 'TEXCOORD_1', 2]];

function numbersOf(attribute, width) {
  const numbers = new Float32Array(width * attribute.count);
  for (let i = 0; i < numbers.length; ++i) numbers[i] = attribute.getComponent(Math.floor(i / width), i % width);
  return numbers;
}

// The numbers of the attributes of a primitive or of one of its morph targets.
async function keyOf(parser, attributes) {
  const key = emptyKey(0);
  for (const [name, , set, width] of ATTRIBUTES) {
    if (attributes[set] === undefined) throw new Error(`a key of the sequence has no ${set}: ${CURE}`);
    key[name] = numbersOf(await parser.getDependency('accessor', attributes[set]), width);
  }
  return key;
}

// The bounds of a segment at all times: what lies between two keys is within them.
function boundsOf(keys) {
  const box = new Box3();
  for (const { positions } of keys) box.union(new Box3().setFromArray(positions));
  return { box, sphere: box.getBoundingSphere(new Sphere(new Vector3())) };
}

async function segmentOf(parser, sequence, segment, picture) {
  const { attributes, indices, targets } = primitiveOf(parser.json, sequence.form, segment), base = await keyOf(parser, attributes);
  const keys = picture ? keysOfPicture(picture, sequence, segment, base.positions.length / 3)
    : keysOfTargets(base, await Promise.all(targets.map(target => keyOf(parser, target))));
  return { ...segment, keys, ...boundsOf(keys), index: await parser.getDependency('accessor', indices) };
}

export class CloudSequence extends Group {
  // From what GLTFLoader returns.
  static async of(/** @type {import('three/addons/loaders/GLTFLoader.js').GLTF} */ { parser, userData }) {
    const sequence = sequenceOf(parser.json);
    if (!sequence) throw new Error('the file is no sequence: make one with `cloudbake sequence`');
    const picture = sequence.form === 'picture'
      ? await pixelsOfPng(await parser.getDependency('bufferView', pictureView(parser.json))) : null;
    const segments = await Promise.all(sequence.segments.map(segment => segmentOf(parser, sequence, segment, picture)));
    const settings = /** @type {any} */ (settingsOf(parser.json, { sequences: true }));
    return new CloudSequence({ ...sequence, segments }, userData.cloudMaterial ?? new CloudMaterial(settings));
  }

  constructor(sequence, material) {
    super();
    this.sequence = sequence;
    this.material = material;
    this.parts = shownSegments(sequence).map(segment => {
      const { keys: [{ positions }], frames: [first], index, box, sphere } = segment;
      const key = emptyKey(positions.length / 3), geometry = new BufferGeometry().setIndex(index);
      writeKeyAt(segment, first, key);
      for (const [name, attribute, , width] of ATTRIBUTES)
        geometry.setAttribute(attribute, new BufferAttribute(key[name], width).setUsage(DynamicDrawUsage));
      Object.assign(geometry, { boundingBox: box.clone(), boundingSphere: sphere.clone() });
      const mesh = new Mesh(geometry, material);
      this.add(mesh);
      return { mesh, segment, key, frame: -1 };
    });
    this.update(0);
  }

  // Of a loop, after which it repeats; else of the last frame.
  get duration() { return this.sequence.period / this.sequence.framesPerSecond; }

  update(seconds) {
    const all = shownAt(this.sequence, seconds);
    for (const { mesh } of this.parts) mesh.visible = false;
    for (const { part, frame, shown } of all) {
      const own = this.parts[part], { mesh } = own;
      mesh.visible = true;
      mesh.userData.cloudShown = shown;
      if (own.frame === frame) continue;
      writeKeyAt(own.segment, frame, own.key);
      own.frame = frame;
      for (const [, attribute] of ATTRIBUTES) mesh.geometry.attributes[attribute].needsUpdate = true;
    }
    setFading(this.material, this, all.length > 1);
  }

  // Another one of the same keys and the same material, which may be at another time.
  clone() { return /** @type {this} */ (new CloudSequence(this.sequence, this.material).copy(this, false)); }

  dispose() {
    setFading(this.material, this, false);
    for (const { mesh } of this.parts) mesh.geometry.dispose();
  }
}
