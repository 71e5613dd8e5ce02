// The pictures of a sculpt in three.js, for three_pictures.mjs.
import { Box3, DoubleSide, Euler, LinearFilter, LoadingManager, Mesh, MeshBasicMaterial, OrthographicCamera, Scene, Sphere,
  SRGBColorSpace, TextureLoader, Vector3, WebGLRenderer } from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { MTLLoader } from 'three/addons/loaders/MTLLoader.js';
import { OBJLoader } from 'three/addons/loaders/OBJLoader.js';
import { PLYLoader } from 'three/addons/loaders/PLYLoader.js';

const SIZE = 240;
const VIEWS = { above: new Euler(-0.57, 0.6, 0, 'YXZ'), below: new Euler(0.63, 3.6, 0, 'YXZ') };

async function plyOf(manager, file) {
  const geometry = await new PLYLoader(manager).loadAsync(file), map = await new TextureLoader(manager).loadAsync('texture.png');
  map.colorSpace = SRGBColorSpace;
  return new Mesh(geometry, new MeshBasicMaterial({ map }));
}

async function objOf(manager, file) {
  const materials = await new MTLLoader(manager).loadAsync(file.replace(/obj$/, 'mtl'));
  return new OBJLoader(manager).setMaterials(materials).loadAsync(file);
}

// The object of a file, once its textures are there too.
async function load(file) {
  const manager = new LoadingManager(), loaded = new Promise((done, fail) => Object.assign(manager, { onLoad: done, onError: fail }));
  manager.itemStart(file);  // so that it is not loaded between two parts
  const object = file.endsWith('.glb') ? (await new GLTFLoader(manager).loadAsync(file)).scene
    : await (file.endsWith('.obj') ? objOf : plyOf)(manager, file);
  manager.itemEnd(file);
  await loaded;
  return object;
}

// Textures are not blended over levels, whose values depend on which way up an image is kept.
function unlit({ map }) {
  Object.assign(map, { minFilter: LinearFilter, magFilter: LinearFilter, generateMipmaps: false, needsUpdate: true });
  return new MeshBasicMaterial({ map, side: DoubleSide });
}

const renderer = new WebGLRenderer({ antialias: false, alpha: true, preserveDrawingBuffer: true });
renderer.setPixelRatio(1);
renderer.setSize(SIZE, SIZE);

// PNG files as data URIs, by view.
export async function draw(file) {
  const scene = new Scene();
  scene.add(await load(file));
  scene.updateMatrixWorld(true);
  scene.traverse(object => { if (object.isMesh) object.material = unlit(object.material); });
  const { center, radius } = new Box3().setFromObject(scene).getBoundingSphere(new Sphere());
  const camera = new OrthographicCamera(-radius, radius, radius, -radius, 0, 4 * radius), pictures = {};
  for (const [view, turn] of Object.entries(VIEWS)) {
    camera.position.copy(new Vector3(0, 0, 2 * radius).applyEuler(turn).add(center));
    camera.setRotationFromEuler(turn);
    renderer.render(scene, camera);
    pictures[view] = renderer.domElement.toDataURL();
  }
  return pictures;
}
