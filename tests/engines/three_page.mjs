// Draws assets in three.js, sample by sample, for web.mjs.
import { BatchedMesh, Color, DirectionalLight, DoubleSide, Fog, FloatType, HemisphereLight, InstancedMesh,
  NoToneMapping, PerspectiveCamera, RGBAFormat, Scene, Vector3, WebGLRenderer, WebGLRenderTarget } from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { CloudSky, CloudbakeLoaderPlugin } from 'cloudbake-materials/three';

export const colorOf = array => new Color(...array);

export async function load(file, parameters) {
  const loader = new GLTFLoader().register(parser => new CloudbakeLoaderPlugin(parser, parameters));
  const gltf = await loader.loadAsync(file), scene = new Scene(), sky = new CloudSky(), meshes = [];
  scene.add(gltf.scene, sky);
  scene.updateMatrixWorld(true);
  gltf.scene.traverse(object => { if (object.isMesh) meshes.push(object); });
  const material = gltf.userData.cloudMaterial;
  return { scene, sky, meshes, material, settings: material && settingsOf(material) };
}

const settingsOf = ({ exponent, bias, extinction, uvSets, flipV, side, harmonicOrder }) =>
  ({ exponent, bias, extinction, uvSets, flipV, side, harmonicOrder });

// What the loader made of a file: the classes of its materials, and what the CloudMaterial read.
export const describe = ({ meshes, settings }) => ({ classes: meshes.map(({ material }) => material.type), settings });

// The first mesh of `single` at the places of the meshes of `nodes`, as instances of an InstancedMesh or a BatchedMesh, with a copy of its
// material.
export function instanced(nodes, single, kind) {
  const [{ geometry }] = single.meshes, material = single.material.clone(), scene = new Scene(), count = nodes.meshes.length;
  const instances = kind === 'InstancedMesh' ? new InstancedMesh(geometry, material, count)
    : new BatchedMesh(count, geometry.attributes.position.count, geometry.index.count, material);
  const shape = kind === 'BatchedMesh' && instances.addGeometry(geometry);
  nodes.meshes.forEach((placed, index) => instances.setMatrixAt(kind === 'BatchedMesh' ? instances.addInstance(shape) : index,
    placed.matrixWorld));
  scene.add(instances, single.sky);
  return { ...single, scene, material };
}

let renderer;
export const rendererOf = ([width, height]) => {
  if (!renderer) {
    renderer = new WebGLRenderer({ antialias: false, preserveDrawingBuffer: true });
    renderer.setPixelRatio(1);
    document.body.append(renderer.domElement);
  }
  renderer.setSize(width, height);
  return renderer;
};

export function prepare({ scene, sky, material, settings }, { size: [width, height], camera, sun, colors, light, fog, changes = {} }) {
  const eye = new PerspectiveCamera(camera.fov, width / height, camera.distance / 100, camera.distance * 10);
  eye.position.set(...camera.from);
  eye.lookAt(...camera.at);
  for (const own of [material, sky.material])
    own.setValues({ sunDirection: new Vector3(...sun), sunColor: colorOf(colors.sun_color), tone: 'renderer' });
  const [zenith, lowSky, horizon, ground] = ['zenith', 'low_sky', 'horizon', 'ground'].map(name => colorOf(colors[name]));
  sky.material.setValues({ zenith, lowSky, horizon, ground });
  const { doubleSided, ...others } = changes;
  material.setValues({ ambientSky: colorOf(colors.ambient_sky), ambientGround: colorOf(colors.ambient_ground), ...settings, ...others });
  if (doubleSided) material.side = DoubleSide;
  material.sunLight = light ? lightTowards(scene, sun) : null;
  scene.fog = fog ? new Fog(colorOf(fog), 0, 1e-6) : null;
  return eye;
}

function lightTowards(scene, sun) {
  const light = new DirectionalLight();
  light.target.position.set(1, 2, 3);
  light.position.set(...sun).multiplyScalar(7).add(light.target.position);
  scene.add(light, light.target);
  return light;
}

// The linear values of the mean over samples, rows from the top.
export function draw(subject, view) {
  const { size: [width, height], places } = view, eye = prepare(subject, view), own = rendererOf(view.size);
  const target = new WebGLRenderTarget(width, height, { type: FloatType, format: RGBAFormat }), read = new Float32Array(4 * width * height);
  const sum = new Float64Array(3 * width * height);
  own.setRenderTarget(target);
  for (const [i, [x, y]] of places.entries()) {
    if (subject.material) subject.material.ditherShift = i / places.length;
    eye.setViewOffset(width, height, x - 0.5, y - 0.5, width, height);
    own.render(subject.scene, eye);
    own.readRenderTargetPixels(target, 0, 0, width, height, read);
    for (let v = 0; v < sum.length; ++v)
      sum[v] += read[4 * (width * (height - 1 - Math.floor(v / 3 / width)) + Math.floor(v / 3) % width) + v % 3] / places.length;
  }
  own.setRenderTarget(null);
  target.dispose();
  return sum;
}

// The 8 bits of the canvas, one sample per pixel.
export function drawToCanvas(subject, view, tone) {
  const eye = prepare(subject, view), own = rendererOf(view.size);
  own.toneMapping = NoToneMapping;
  for (const material of [subject.material, subject.sky.material]) material.tone = tone;
  own.render(subject.scene, eye);
  return canvasOf(own);
}

// Three values per pixel, rows from the top.
export function canvasOf(own) {
  const { width, height } = own.domElement, gl = own.getContext(), rows = new Uint8Array(4 * width * height);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, rows);
  return new Uint8Array(3 * width * height).map((_, i) => rows[4 * (width * (height - 1 - Math.floor(i / 3 / width))
    + Math.floor(i / 3) % width) + i % 3]);
}

// The 8 bits of a file with its own materials, seen from a place, by a sun from there and a sky.
export async function drawOwn(file, from, size) {
  const { scene: model } = await new GLTFLoader().loadAsync(file), scene = new Scene();
  const eye = new PerspectiveCamera(35, size[0] / size[1], 0.1, 100), sun = new DirectionalLight(0xffffff, 2);
  eye.position.set(...from);
  eye.lookAt(0, 0, 0);
  sun.position.set(...from).add(new Vector3(1, 2, -1));
  scene.add(model, sun, new HemisphereLight(0xaaccff, 0x443322, 1));
  const own = rendererOf(size);
  own.toneMapping = NoToneMapping;
  own.render(scene, eye);
  return canvasOf(own);
}
