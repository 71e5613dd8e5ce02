// What the loaders of three.js find in files.
//
//   node three_shapes.mjs FILES.json FOLDER
//
// FILES.json: paths by number. Writes NUMBER.shape or NUMBER.error into FOLDER; shapes.py has the form of a shape.
// @ts-check
import { readFileSync, writeFileSync } from 'node:fs';
import { dirname, extname, join } from 'node:path';
import { XmlParser } from './xml_document.mjs';

// What loaders expect of a browser. Textures and requests never come: only shapes count.
Object.assign(globalThis, { self: globalThis, window: { innerWidth: 1, innerHeight: 1 }, DOMParser: XmlParser });
Object.assign(globalThis, { document: { createElementNS: () => ({ addEventListener() {}, removeEventListener() {} }) } });
Object.assign(globalThis, { Request: class {}, fetch: () => new Promise(() => {}) });
console.warn = () => {};
console.error = () => {};

const three = await import('three');
const addons = 'three/addons/loaders/';
const [{ OBJLoader }, { PLYLoader }, { STLLoader }, { ColladaLoader }, { GLTFLoader }, { FBXLoader }, { TDSLoader }] = await Promise.all(
  ['OBJ', 'PLY', 'STL', 'Collada', 'GLTF', 'FBX', 'TDS'].map((name) => import(`${addons}${name}Loader.js`)));

const NAMELESS = new Set([undefined, '', three.Loader.DEFAULT_MATERIAL_NAME]);

/** @typedef {{node: string, material: string | null, points: number[], uvs: number[][], colors: number[]}} Part */

/** @param {Buffer} buffer */
const bytesOf = (buffer) => buffer.buffer.slice(buffer.byteOffset, buffer.byteOffset + buffer.byteLength);

/** @param {any} geometry */
const sceneOf = (geometry) => {
  const scene = new three.Scene();
  scene.add(new three.Mesh(geometry));
  return scene;
};

/** Lets GLTFLoader read buffers beside the file, and no images.
 * @param {any} parser */
const filesPlugin = (parser) => {
  parser.fileLoader.load = (/** @type {string} */ url, /** @type {Function} */ done, /** @type {any} */ _,
    /** @type {Function} */ fail) => {
    try {
      const inside = url.startsWith('data:');
      const data = inside ? Buffer.from(url.slice(url.indexOf(',') + 1), 'base64') : readFileSync(decodeURIComponent(url));
      done(bytesOf(data));
    } catch (problem) {
      fail(problem);
    }
  };
  parser.loadTexture = parser.loadTextureImage = async () => new three.Texture();
  return { name: 'files' };
};

/** The scene of a file, and by object what identifies its node.
 * @param {string} path
 * @returns {Promise<{scene: any, nodeOf: (object: any) => string, materialOf?: (material: any) => number | undefined}>} */
const load = async (path) => {
  const data = readFileSync(path);
  const itself = (/** @type {any} */ object) => object.uuid;
  switch (extname(path).toLowerCase()) {
    case '.obj': return { scene: new OBJLoader().parse(data.toString('utf8')), nodeOf: itself };
    case '.ply': {
      const has_faces = /^element\s+(face|tristrips)\s+[1-9]/m.test(data.toString('latin1').split('end_header')[0]);
      return { scene: has_faces ? sceneOf(new PLYLoader().parse(bytesOf(data))) : new three.Scene(), nodeOf: itself };
    }
    case '.stl': return { scene: sceneOf(new STLLoader().parse(bytesOf(data))), nodeOf: itself };
    case '.dae': return { scene: new ColladaLoader().parse(data.toString('utf8'), '').scene, nodeOf: itself };
    case '.fbx': return { scene: new FBXLoader().parse(bytesOf(data), ''), nodeOf: itself };
    case '.3ds': return { scene: new TDSLoader().parse(bytesOf(data), ''), nodeOf: itself };
    default: {
      const gltf = await new GLTFLoader().register(filesPlugin).parseAsync(bytesOf(data), join(dirname(path), '/'));
      const nodeOf = (/** @type {any} */ object) => {
        while (object.parent && gltf.parser.associations.get(object)?.nodes === undefined) object = object.parent;
        return object.uuid;
      };
      return { scene: gltf.scene, nodeOf, materialOf: (material) => gltf.parser.associations.get(material)?.materials };
    }
  }
};

/** The corners of triangles [first, first + count) of a mesh, as numbers of vertices.
 * @param {any} geometry @param {number} first @param {number} count */
const cornersOf = (geometry, first, count) => {
  const end = Math.min(first + count, geometry.index ? geometry.index.count : geometry.attributes.position.count);
  const corners = [];
  for (let i = first; i < end; ++i) corners.push(geometry.index ? geometry.index.getX(i) : i);
  return corners;
};

/** @param {any} attribute @param {number[]} corners @param {number} width */
const numbersOf = (attribute, corners, width) => {
  const numbers = [];
  for (const corner of corners)
    for (let k = 0; k < width; ++k) numbers.push(k < attribute.itemSize ? attribute.getComponent(corner, k) : 1);
  return numbers;
};

/** @param {any} mesh @param {string} node @param {(material: any) => string | number | undefined} materialOf @returns {Part[]} */
const partsOf = (mesh, node, materialOf) => {
  const { geometry } = mesh;
  const { attributes } = geometry;
  const every = { start: 0, count: Infinity, materialIndex: 0 };
  const groups = Array.isArray(mesh.material) && geometry.groups.length ? geometry.groups : [every];
  return groups.map((/** @type {any} */ group) => {
    const corners = cornersOf(geometry, group.start, group.count);
    const material = Array.isArray(mesh.material) ? mesh.material[group.materialIndex] : mesh.material;
    const point = new three.Vector3();
    const points = corners.flatMap((corner) => {
      point.fromBufferAttribute(attributes.position, corner).applyMatrix4(mesh.matrixWorld);
      return [point.x, point.y, point.z];
    });
    const uvs = ['uv', 'uv1', 'uv2', 'uv3'].filter((name) => attributes[name]).map((name) => numbersOf(attributes[name], corners, 2));
    const colors = attributes.color ? numbersOf(attributes.color, corners, 4) : [];
    const name = material && materialOf(material);
    return { node, material: NAMELESS.has(name) ? null : String(name), points, uvs, colors };
  });
};

/** @param {string} path @param {Part[]} parts */
const writeShape = (path, parts) => {
  const head = Buffer.from(JSON.stringify(parts.map((part) => ({ node: part.node, material: part.material, corners: part.points.length / 3,
    uv_sets: part.uvs.length, colors: part.colors.length > 0 }))));
  const size = Buffer.alloc(4);
  size.writeUInt32LE(head.length);
  const numbers = parts.flatMap((part) => [part.points, ...part.uvs, part.colors].map((row) => Buffer.from(new Float32Array(row).buffer)));
  writeFileSync(path, Buffer.concat([size, head, ...numbers]));
};

/** @param {any} mesh @param {number} i */
const instanceMatrix = (mesh, i) => {
  const matrix = new three.Matrix4();
  mesh.getMatrixAt(i, matrix);
  return matrix;
};

const [list, folder] = process.argv.slice(2);
for (const [number, path] of Object.entries(JSON.parse(readFileSync(list, 'utf8')))) {
  try {
    const { scene, nodeOf, materialOf = (material) => material.name } = await load(path);
    scene.updateMatrixWorld(true);
    /** @type {Part[]} */
    const parts = [];
    scene.traverseVisible((/** @type {any} */ object) => {
      if (!object.isMesh) return;
      const place = object.matrixWorld.clone();
      for (let i = 0; i < (object.count ?? 1); ++i) {  // of an InstancedMesh; each instance is an object
        if (object.isInstancedMesh) object.matrixWorld.multiplyMatrices(place, instanceMatrix(object, i));
        parts.push(...partsOf(object, nodeOf(object) + (i ? ` ${i}` : ''), materialOf));
      }
    });
    writeShape(join(folder, `${number}.shape`), parts);
  } catch (problem) {
    writeFileSync(join(folder, `${number}.error`), String(problem));
  }
}
process.exit(0);  // loaders of textures may wait for ever
