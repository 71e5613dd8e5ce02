// Clouds that change (`cloudbake sequence`), in Babylon.js.
import { VertexBuffer } from '@babylonjs/core/Buffers/buffer.js';
import { BoundingInfo } from '@babylonjs/core/Culling/boundingInfo.js';
import { Material } from '@babylonjs/core/Materials/material.js';
import { Quaternion, Vector3 } from '@babylonjs/core/Maths/math.vector.js';
import { Mesh } from '@babylonjs/core/Meshes/mesh.js';
import { TransformNode } from '@babylonjs/core/Meshes/transformNode.js';
import { settingsOf } from './asset.js';
import { CloudMaterial } from './babylon.js';
import { boundsOf, emptyKey, shownAt, shownSegments, writeKeyAt } from './sequence.js';
import { setFading } from './sequence_fade.js';
import { readSequence } from './sequence_file.js';

// The names of the numbers of a key in a mesh of Babylon.js, and how many a vertex has.
/** @type {[string, string, number][]} */
const ATTRIBUTES = [['positions', VertexBuffer.PositionKind, 3], ['normals', VertexBuffer.NormalKind, 3],
  ['first', VertexBuffer.UVKind, 2], ['second', VertexBuffer.UV2Kind, 2]];

export class CloudSequence extends TransformNode {
  static async load(url, scene) {
    const answer = await fetch(url);
    if (!answer.ok) throw new Error(`${url}: the server answers ${answer.status}`);
    return CloudSequence.of(await answer.arrayBuffer(), scene);
  }

  static async of(file, scene) {
    const { json, sequence } = await readSequence(file), settings = /** @type {any} */ (settingsOf(json, { sequences: true }));
    const segments = sequence.segments.map(segment => ({ ...segment, bounds: boundsOf(segment.keys) }));
    return new CloudSequence({ ...sequence, segments }, new CloudMaterial('cloud', scene, settings), scene);
  }

  constructor(sequence, material, scene) {
    super('sequence', scene);
    this.sequence = sequence;
    this.material = material;
    const inner = new TransformNode('segments', scene);
    inner.parent = this;
    if (!scene.useRightHandedSystem) {  // as the loader of glTF does
      inner.rotationQuaternion = new Quaternion(0, 1, 0, 0);
      inner.scaling.z = -1;
    }
    this.parts = shownSegments(sequence).map(segment => this.partOf(segment, inner));
    this.update(0);
  }

  partOf(segment, parent) {
    const { keys: [{ positions }], frames: [first], index, bounds: [low, high] } = segment, scene = this.getScene();
    const key = emptyKey(positions.length / 3), mesh = new Mesh('segment', scene);
    writeKeyAt(segment, first, key);
    mesh.sideOrientation = scene.useRightHandedSystem ? Material.CounterClockWiseSideOrientation : Material.ClockWiseSideOrientation;
    for (const [name, kind, width] of ATTRIBUTES) mesh.setVerticesData(kind, key[name], true, width);
    mesh.setIndices(index);
    mesh.setBoundingInfo(new BoundingInfo(Vector3.FromArray(low), Vector3.FromArray(high)));
    mesh.material = this.material;
    mesh.parent = parent;
    mesh.metadata = {};
    return { mesh, segment, key, frame: -1 };
  }

  // Of a loop, after which it repeats; else of the last frame.
  get duration() { return this.sequence.period / this.sequence.framesPerSecond; }

  update(seconds) {
    const all = shownAt(this.sequence, seconds);
    for (const { mesh } of this.parts) mesh.isVisible = false;
    for (const { part, frame, shown } of all) {
      const own = this.parts[part], { mesh } = own;
      mesh.isVisible = true;
      mesh.metadata.cloudShown = shown;
      if (own.frame === frame) continue;
      writeKeyAt(own.segment, frame, own.key);
      own.frame = frame;
      for (const [name, kind] of ATTRIBUTES) mesh.updateVerticesData(kind, own.key[name]);
    }
    setFading(this.material, this, all.length > 1);
  }

  // Another one of the same keys and the same material, which may be at another time.
  copy() { return new CloudSequence(this.sequence, this.material, this.getScene()); }

  dispose() {
    setFading(this.material, this, false);
    super.dispose();
  }
}
