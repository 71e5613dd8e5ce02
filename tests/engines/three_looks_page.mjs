// Draws triangles and assets with settings of CloudMaterial in three.js, for looks.mjs.
import { BufferAttribute, BufferGeometry, Color, DepthTexture, DirectionalLight, FloatType, InstancedMesh, Matrix4, Mesh, MeshBasicMaterial,
  MeshStandardMaterial, PerspectiveCamera, PlaneGeometry, PointLight, Scene, SpotLight, Vector3, WebGLRenderTarget } from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { CloudLevels, CloudMaterial, CloudShadow, CloudbakeLoaderPlugin } from 'cloudbake-materials/three';
import { PaintedClouds } from 'cloudbake-materials/three/painted';
import { CloudShade } from 'cloudbake-materials/three/shade';
import { changesOf } from './changes.mjs';
import { canvasOf, colorOf, rendererOf } from './three_page.mjs';

export { describe, draw, load } from './three_page.mjs';

function geometryOf({ places, normals, lobe }) {
  const geometry = new BufferGeometry(), set = (name, values, size) =>
    geometry.setAttribute(name, new BufferAttribute(new Float32Array(values.flat()), size));
  set('position', places, 3);
  set('normal', normals, 3);
  set('uv', places.map(() => lobe.slice(0, 2)), 2);
  set('uv1', places.map(() => lobe.slice(2)), 2);
  return geometry;
}

function lightsOf(lamps, scene) {
  return lamps.map(({ place, color, strength, range, axis, angles, radius }) => {
    const light = axis ? new SpotLight(new Color(...color), strength, range, angles[1], 1 - angles[0] / angles[1])
      : new PointLight(new Color(...color), strength, range);
    light.position.set(...place);
    light.userData.radius = radius;
    scene.add(light);
    if (axis) {
      light.target.position.set(...place.map((x, i) => x + axis[i]));
      scene.add(light.target);
    }
    return light;
  });
}

// The linear RGBA of a triangle before the eye at the origin, which looks along -z, rows from the top; `solid`: the distance of a plane
// behind it whose depth the material is given.
export function drawFlat({ size: [width, height], fov, triangle, lamps = [], solid, samples = 0, settings }) {
  const renderer = rendererOf([width, height]), scene = new Scene(), eye = new PerspectiveCamera(fov, width / height, 0.1, 1000);
  const black = new Color(0, 0, 0), white = new Color(0.5, 0.5, 0.5), ambient = lamps.length ? black : white;
  const material = new CloudMaterial({ uvSets: [0, 1], sunColor: black, ambientSky: ambient, ambientGround: ambient, fog: false,
    ...settings });
  material.lamps = lightsOf(lamps, scene);
  if (solid) material.depthTexture = depthOf(renderer, eye, solid, [width, height]);
  scene.add(new Mesh(geometryOf(triangle), material));
  const target = new WebGLRenderTarget(width, height, { type: FloatType, samples }), rows = new Float32Array(4 * width * height);
  renderer.setClearColor(0, 0);
  renderer.setRenderTarget(target);
  renderer.render(scene, eye);
  renderer.readRenderTargetPixels(target, 0, 0, width, height, rows);
  renderer.setRenderTarget(null);
  renderer.setClearColor(0, 1);
  return rows.map((_, i) => rows[4 * (width * (height - 1 - Math.floor(i / 4 / width)) + Math.floor(i / 4) % width) + i % 4]);
}

function depthOf(renderer, eye, away, [width, height]) {
  const target = new WebGLRenderTarget(width, height, { depthTexture: new DepthTexture(width, height, FloatType) }), scene = new Scene();
  const plane = new Mesh(new PlaneGeometry(1e3, 1e3), new MeshBasicMaterial());
  plane.position.z = -away;
  scene.add(plane);
  renderer.setRenderTarget(target);
  renderer.render(scene, eye);
  renderer.setRenderTarget(null);
  return target.depthTexture;
}

// The shade of the grid of a cloud.
async function shadeOfCloud(file, sun) {
  const { scene } = await loaderOf().loadAsync(file), shade = new CloudShade().add(scene);
  shade.update(new Vector3(...sun));
  return shade;
}

// The red of a lit floor below the eye at places of the world, with the shadow of a picture or the shade of a cloud over that without.
export async function shadowAt({ picture, cloud, strength, places, sun }) {
  const ratio = [];
  for (const shadow of [null, await (cloud ? shadeOfCloud(cloud, sun) : CloudShadow.load(picture, strength))]) {
    const size = [65, 65], renderer = rendererOf(size), scene = new Scene(), eye = new PerspectiveCamera(60, 1, 0.1, 100);
    const light = new DirectionalLight(0xffffff, 2), material = new MeshStandardMaterial({ roughness: 1 });
    light.position.set(...sun);
    const floor = new Mesh(new PlaneGeometry(50, 50), shadow ? shadow.darken(material) : material);
    floor.rotation.x = -Math.PI / 2;
    scene.add(light, floor);
    const target = new WebGLRenderTarget(...size, { type: FloatType }), value = new Float32Array(4);
    const values = places.map(([x, y, z]) => {
      floor.position.y = y;
      eye.position.set(x, y + 6, z + 6);
      eye.lookAt(x, y, z);
      renderer.setRenderTarget(target);
      renderer.render(scene, eye);
      renderer.readRenderTargetPixels(target, 32, 32, 1, 1, value);
      return value[0];
    });
    renderer.setRenderTarget(null);
    ratio.push(values);
  }
  return ratio[1].map((value, i) => value / ratio[0][i]);
}

// The mean light of the sun on clouds at places, seen one by one from the sun's side: without shade, shaded as meshes, and as instances.
export async function shadeOf({ file, places, sun }) {
  const gltf = await loaderOf().loadAsync(file), black = new Color(0, 0, 0), size = [64, 64], found = [], geometry = meshOf(gltf).geometry;
  const material = gltf.userData.cloudMaterial, target = new WebGLRenderTarget(...size, { type: FloatType });
  material.setValues({ sunDirection: new Vector3(...sun), sunColor: new Color(1, 1, 1), ambientSky: black, ambientGround: black,
    tone: 'renderer',
    phase: { share: 0 }, fog: false });
  for (const kind of ['none', 'meshes', 'instances']) {
    const scene = new Scene(), renderer = rendererOf(size), rows = new Float32Array(4 * size[0] * size[1]);
    const instances = new InstancedMesh(geometry.clone(), material, places.length);
    places.forEach((place, i) => {
      const mesh = new Mesh(geometry, material);
      mesh.position.set(...place);
      instances.setMatrixAt(i, new Matrix4().makeTranslation(...place));
      if (kind !== 'instances') scene.add(mesh);
    });
    if (kind === 'instances') scene.add(instances);
    material.cloudShade = null;
    if (kind !== 'none') new CloudShade().add(scene).update(new Vector3(...sun));
    const eye = new PerspectiveCamera(30, 1, 0.1, 100);
    found.push(places.map(([x, y, z]) => {
      eye.position.set(x + 4 * sun[2], y, z - 4 * sun[0]);
      eye.lookAt(x, y, z);
      renderer.setRenderTarget(target);
      renderer.setClearColor(0, 0);
      renderer.clear();
      renderer.render(scene, eye);
      renderer.readRenderTargetPixels(target, 0, 0, ...size, rows);
      renderer.setRenderTarget(null);
      return rows.reduce((sum, value, i) => sum + (i % 4 === 0 ? value : 0), 0) / (size[0] * size[1]);
    }));
  }
  return found;
}

const meshOf = ({ scene }) => {
  let found = null;
  scene.traverse(object => { if (object.isMesh) found ??= object; });
  return found;
};

const loaderOf = () => new GLTFLoader().register(parser => new CloudbakeLoaderPlugin(parser, { tone: 'cloudbake' }));

// How the canvas changes between distances of the eye from levels of a cloud, or from the first of them, by the material or painted; and
// the levels that are drawn.
export async function drawLevels({ files, size: [width, height], at, distances, longest, switchBand, single = false, painted = false,
  clear }) {
  const gltfs = await Promise.all(files.map(file => loaderOf().loadAsync(file))), scene = new Scene();
  scene.background = colorOf(clear);
  const levels = new CloudLevels(single ? gltfs.slice(0, 1) : gltfs, { switchBand, pictureHeight: height });
  scene.add(levels);
  const eye = new PerspectiveCamera(35, width / height, 0.1, 1000), renderer = rendererOf([width, height]);
  const pass = painted ? new PaintedClouds(scene, eye, { size: longest, tone: 'cloudbake', swirl: { strength: 0 } }) : null;
  const shown = [], pictures = distances.map(away => {
    eye.position.set(at[0] + 0.3 * away, at[1] + 0.2 * away, at[2] + away);
    eye.lookAt(...at);
    if (pass) pass.render(renderer);
    else renderer.render(scene, eye);
    shown.push(levels.levels.map(({ object }) => object.visible));
    return canvasOf(renderer);
  });
  return { changes: changesOf(pictures), shown };
}
