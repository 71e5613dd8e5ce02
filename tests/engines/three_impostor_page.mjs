// Draws lobe impostors in three.js, for impostor.mjs.
import { BatchedMesh, FloatType, InstancedMesh, Matrix4, Mesh, NoToneMapping, OrthographicCamera, PerspectiveCamera, RGBAFormat, Scene,
  Vector3, WebGLRenderTarget } from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { CloudSky, CloudbakeLoaderPlugin, sortImpostors } from 'cloudbake-materials/three';
import { colorOf, rendererOf } from './three_page.mjs';

// The file's scene as it is loaded, with a sky.
export async function load(file, parameters) {
  const gltf = await new GLTFLoader().register(parser => new CloudbakeLoaderPlugin(parser, parameters)).loadAsync(file);
  const meshes = [];
  gltf.scene.traverse(object => { if (object.isMesh) meshes.push(object); });
  return { gltf, meshes, material: gltf.userData.impostorMaterial, sky: new CloudSky() };
}

export function describe({ meshes, material }) {
  const { exponent, extinction, ofVolume, center, radius, atlas, lobeTexture, restTexture } = material ?? {};
  return { types: meshes.map(mesh => mesh.material.type), exponent, extinction, ofVolume, center, radius, atlas,
    spaces: [lobeTexture?.colorSpace, restTexture?.colorSpace] };
}

// The impostor at places, each a matrix by columns, as nodes or as instances.
export function place(subject, matrices, kind) {
  const { meshes: [{ geometry }], material, sky } = subject, scene = new Scene(), all = matrices.map(one => new Matrix4().fromArray(one));
  scene.add(sky);
  if (kind === 'nodes')
    for (const matrix of all) {
      const mesh = new Mesh(geometry, material);
      mesh.applyMatrix4(matrix);
      mesh.matrixAutoUpdate = false;
      mesh.matrix.copy(matrix);
      scene.add(mesh);
    }
  else {
    const is_batch = kind === 'BatchedMesh';
    const instances = is_batch ? new BatchedMesh(all.length, 4, 6, material) : new InstancedMesh(geometry, material, all.length);
    const shape = is_batch && instances.addGeometry(geometry);
    all.forEach((matrix, i) => instances.setMatrixAt(is_batch ? instances.addInstance(shape) : i, matrix));
    instances.frustumCulled = false;
    scene.add(instances);
    subject.instances = is_batch ? null : instances;
  }
  subject.scene = scene;
}

function prepare({ sky, material, instances }, { size: [width, height], camera, sun, colors, changes = {}, unsorted, ortho }) {
  const aspect = width / height, planes = [camera.distance / 100, camera.distance * 10];
  const eye = ortho ? new OrthographicCamera(-ortho * aspect, ortho * aspect, ortho, -ortho, ...planes)
    : new PerspectiveCamera(camera.fov, aspect, ...planes);
  eye.position.set(...camera.from);
  eye.lookAt(...camera.at);
  eye.updateMatrixWorld();
  for (const own of [material, sky.material])
    own.setValues({ sunDirection: new Vector3(...sun), sunColor: colorOf(colors.sun_color), tone: 'renderer' });
  const [zenith, lowSky, horizon, ground] = ['zenith', 'low_sky', 'horizon', 'ground'].map(name => colorOf(colors[name]));
  sky.material.setValues({ zenith, lowSky, horizon, ground });
  material.setValues({ ambientSky: colorOf(colors.ambient_sky), ambientGround: colorOf(colors.ambient_ground), ...changes });
  if (instances && !unsorted) sortImpostors(instances, eye);
  return eye;
}

// The linear values of one sample per pixel, rows from the top.
export function draw(subject, view) {
  const { size: [width, height] } = view, eye = prepare(subject, view), own = rendererOf(view.size);
  const target = new WebGLRenderTarget(width, height, { type: FloatType, format: RGBAFormat }), read = new Float32Array(4 * width * height);
  own.toneMapping = NoToneMapping;
  own.setRenderTarget(target);
  own.render(subject.scene, eye);
  own.readRenderTargetPixels(target, 0, 0, width, height, read);
  own.setRenderTarget(null);
  target.dispose();
  return Array.from({ length: 3 * width * height }, (_, v) =>
    read[4 * (width * (height - 1 - Math.floor(v / 3 / width)) + Math.floor(v / 3) % width) + v % 3]);
}
