// Changes baked GLBs for web.mjs.
import { Matrix3, Matrix4, Quaternion, Vector3 } from 'three';

import { chunksOf, glbOf, valuesOf } from '../browser/glb.mjs';

// The GLB with more bytes at the end of its buffer.
export function glbWith({ json, binary }, more = []) {
  const longer = Buffer.concat([binary, ...more]);
  json.buffers[0].byteLength = longer.length;
  return glbOf({ json, binary: longer });
}

// A mesh that nodes show as it is, mirrored, and sheared by a parent that stretches what its child turns.
export function nodesGlb(bytes) {
  const asset = chunksOf(bytes), { json } = asset, { mesh, translation, scale } = json.nodes.find(node => node.mesh !== undefined);
  json.nodes = [
    { mesh },
    { mesh, translation: [1.3, 0.5, -0.3], rotation: [0, 0.6, 0, 0.8], scale: [-0.8, 1, 0.9] },
    { children: [3], translation: [-1.3, -0.4, 0.3], scale: [1.1, 0.6, 0.8] },
    { mesh, rotation: [0.36, 0.48, 0, 0.8] },
  ];
  if (json.asset.extras.cloudbake.layout === 'lobe-packed')  // its nodes undo the grid of the positions
    for (const node of json.nodes.filter(one => one.mesh !== undefined)) {
      delete node.mesh;
      node.children = [json.nodes.push({ mesh, translation, scale }) - 1];
    }
  json.scenes[json.scene ?? 0].nodes = [0, 1, 2];
  return glbWith(asset);
}

// The file of nodesGlb with the meshes moved in their own space: by a node or by a morph target; or also turned, by a node or by a joint.
export function movedGlb(bytes, by) {
  const asset = chunksOf(bytes), { json, binary } = asset, offset = [0.2, -0.1, 0.3];
  const { POSITION } = json.meshes[0].primitives[0].attributes, { count } = json.accessors[POSITION], more = [];
  const store = (values, type) => {
    json.bufferViews.push({ buffer: 0, byteOffset: binary.length + more.reduce((sum, { length }) => sum + length, 0),
      byteLength: values.byteLength });
    more.push(Buffer.from(values.buffer));
    return json.accessors.push({ bufferView: json.bufferViews.length - 1, componentType: 5126, count, type,
      ...type === 'VEC3' ? { min: offset, max: offset } : {} }) - 1;
  };
  const repeated = values => Float32Array.from({ length: values.length * count }, (_, i) => values[i % values.length]);
  const [mesh] = json.meshes;
  if (by === 'morph')
    Object.assign(mesh, {
      primitives: mesh.primitives.map(primitive => ({ ...primitive, targets: [{ POSITION: store(repeated(offset), 'VEC3') }] })),
      weights: [1],
    });
  if (by === 'joint') {
    const WEIGHTS_0 = store(repeated([1, 0, 0, 0]), 'VEC4');
    const view = json.bufferViews.push({ buffer: 0, byteOffset: binary.length + more[0].length, byteLength: 4 * count }) - 1;
    more.push(Buffer.alloc(4 * count));
    const JOINTS_0 = json.accessors.push({ bufferView: view, componentType: 5121, count, type: 'VEC4' }) - 1;
    for (const { attributes } of mesh.primitives) Object.assign(attributes, { WEIGHTS_0, JOINTS_0 });
  }
  const { nodes } = json, shown = [];
  json.skins = by === 'joint' ? [] : undefined;
  for (const node of nodes.filter(one => one.mesh === 0)) {
    if (by === 'morph') continue;
    delete node.mesh;
    const turn = by === 'node' ? {} : { rotation: [0.6, 0, 0, 0.8], scale: [1, 1.2, 0.9] };
    const child = nodes.push({ translation: offset, ...turn, ...by === 'joint' ? {} : { mesh: 0 } }) - 1;
    node.children = [child];
    if (by === 'joint') shown.push(nodes.push({ mesh: 0, skin: json.skins.push({ joints: [child] }) - 1 }) - 1);
  }
  json.scenes[json.scene ?? 0].nodes.push(...shown);
  return glbWith(asset, more);
}

// The same without the triangles that face away from `eye`.
export function opaqueGlb(bytes, eye) {
  const asset = chunksOf(bytes), { json, binary } = asset, more = [];
  let end = binary.length;
  const visit = (index, parent) => {
    const node = json.nodes[index];
    const matrix = parent.clone().multiply(new Matrix4().compose(new Vector3(...node.translation ?? [0, 0, 0]),
      new Quaternion(...node.rotation ?? [0, 0, 0, 1]),
      new Vector3(...node.scale ?? [1, 1, 1])));
    for (const child of node.children ?? []) visit(child, matrix);
    if (node.mesh === undefined) return;
    const primitives = json.meshes[node.mesh].primitives.map(primitive => {
      const kept = Uint32Array.from(facing(valuesOf(asset, primitive.attributes.POSITION), valuesOf(asset, primitive.indices),
        matrix, new Vector3(...eye)));
      json.bufferViews.push({ buffer: 0, byteOffset: end, byteLength: kept.byteLength });
      more.push(Buffer.from(kept.buffer));
      end += kept.byteLength;
      return { ...primitive,
        indices: json.accessors.push({ bufferView: json.bufferViews.length - 1, componentType: 5125,
        count: kept.length, type: 'SCALAR' }) - 1 };
    });
    node.mesh = json.meshes.push({ primitives }) - 1;
  };
  for (const root of json.scenes[json.scene ?? 0].nodes) visit(root, new Matrix4());
  return glbWith(asset, more);
}

// The triangles whose front is towards `eye`. A mirror turns fronts, as glTF says.
export function facing(positions, corners, matrix, eye) {
  const points = Array.from({ length: positions.length / 3 }, (_, v) =>
    new Vector3(...positions.slice(3 * v, 3 * v + 3)).applyMatrix4(matrix)), kept = [];
  const sense = Math.sign(new Matrix3().setFromMatrix4(matrix).determinant());
  for (let t = 0; t < corners.length; t += 3) {
    const [a, b, c] = [...corners.slice(t, t + 3)].map(v => points[v]);
    if (sense * b.clone().sub(a).cross(c.clone().sub(a)).dot(eye.clone().sub(a)) > 0) kept.push(...corners.slice(t, t + 3));
  }
  return kept;
}

// A baked mesh and a copy of it without the sets of the lobes; or, not `baked`, a file without what cloudbake says about it.
export function otherGlb(bytes, baked) {
  const asset = chunksOf(bytes), { json } = asset, node = json.nodes.find(({ mesh }) => mesh !== undefined);
  const sets = json.asset.extras.cloudbake.uv_sets;
  if (baked) {
    const primitives = json.meshes[node.mesh].primitives.map(primitive => ({ ...primitive, material: json.materials.length,
      attributes: Object.fromEntries(Object.entries(primitive.attributes).filter(([name]) =>
        !sets.some(set => name === `TEXCOORD_${set}`))) }));
    json.materials.push({});
    json.scenes[json.scene ?? 0].nodes.push(json.nodes.push({ mesh: json.meshes.push({ primitives }) - 1, translation: [3, 0, 0] }) - 1);
  } else {
    delete json.asset.extras;
  }
  return glbWith(asset);
}
