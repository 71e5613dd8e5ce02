// Draws assets with PaintedClouds, for painted.mjs.
import { ACESFilmicToneMapping, BoxGeometry, Color, DirectionalLight, FloatType, Mesh, MeshBasicMaterial,
  MeshStandardMaterial, NoToneMapping, PCFShadowMap, SphereGeometry, Vector3, WebGLRenderer,
  WebGLRenderTarget } from 'three';
import { EffectComposer } from 'three/addons/postprocessing/EffectComposer.js';
import { OutputPass } from 'three/addons/postprocessing/OutputPass.js';
import { PaintedClouds } from 'cloudbake-materials/three/painted';
import { naiveOf } from './naive.mjs';
import { canvasOf, colorOf, instanced, prepare, rendererOf } from './three_page.mjs';

export { describe, load } from './three_page.mjs';

// A pass that draws as exactly as `preview`, unless the settings say otherwise.
function passFor({ scene }, eye, { colors }, { exact = true, ...settings } = {}) {
  const exactly = exact ? { samplesPerSide: 4 } : {};
  const pass = new PaintedClouds(scene, eye, { tone: 'cloudbake', fogColor: colorOf(colors.horizon), ...exactly, ...settings });
  if (exact) pass.behind.texture.type = FloatType;
  if (exact) pass.behind.samples = 0;
  return pass;
}

function painted(pass, renderer) {
  pass.render(renderer);
  pass.dispose();
  return canvasOf(renderer);
}

export const defaults = () => {
  const { depthSpread, softening, swirl, erosion, phase, fogDensity, halfLambert, volumeGain } = new PaintedClouds();
  return { depthSpread, softening, swirl, erosion, phase, fogDensity, halfLambert, volumeGain };
};

export function paint(subject, view, settings) {
  const eye = prepare(subject, view), { clouds = true, culled = true, near = eye.near } = view;
  eye.near = near;
  eye.updateProjectionMatrix();
  for (const mesh of subject.meshes) Object.assign(mesh, { visible: clouds, frustumCulled: culled });
  const shown = painted(passFor(subject, eye, view, settings), rendererOf(view.size));
  for (const mesh of subject.meshes) Object.assign(mesh, { visible: true, frustumCulled: true });
  return shown;
}

export function paintInstances(nodes, single, view, settings, kind) {
  const subject = instanced(nodes, single, kind);
  return paint({ ...subject, settings: single.settings }, view, settings);
}

// After a picture of another size.
export function paintTwice(subject, view, [width, height]) {
  const pass = passFor(subject, prepare(subject, view), view);
  pass.render(rendererOf([width, height]));
  return painted(pass, rendererOf(view.size));
}

// By an EffectComposer, and to the canvas at once, with the tones of three.js.
export function paintBoth(subject, view) {
  const renderer = rendererOf(view.size), eye = prepare(subject, view), [width, height] = view.size, output = new OutputPass();
  renderer.toneMapping = ACESFilmicToneMapping;
  const composer = new EffectComposer(renderer, new WebGLRenderTarget(width, height, { type: FloatType }));
  composer.addPass(passFor(subject, eye, view, { tone: 'renderer' }));
  composer.addPass(output);
  composer.render();
  const composed = canvasOf(renderer), direct = painted(passFor(subject, eye, view, { tone: 'renderer' }), renderer);
  composer.dispose();
  renderer.toneMapping = NoToneMapping;
  return [composed, direct];
}

// A red ball on the way from the eye to what it looks at, or beyond; with the clouds and without them.
export function paintBall(subject, view, share, options) {
  const renderer = new WebGLRenderer(options), eye = prepare(subject, view), { at, from, distance } = view.camera;
  const ball = redBall(0.03 * distance);
  renderer.setPixelRatio(1);
  renderer.setSize(...view.size);
  ball.position.copy(new Vector3(...from).lerp(new Vector3(...at), share));
  const shown = [];
  for (const [has_ball, has_clouds] of [[true, true], [true, false], [false, true]]) {
    subject.scene.remove(ball);
    if (has_ball) subject.scene.add(ball);
    for (const mesh of subject.meshes) mesh.visible = has_clouds;
    shown.push(painted(passFor(subject, eye, view), renderer));
  }
  for (const mesh of subject.meshes) mesh.visible = true;
  renderer.dispose();
  return shown;
}

const redBall = radius => new Mesh(new SphereGeometry(radius), new MeshBasicMaterial({ color: 0xff0000 }));

// A ball before the cloud, by several settings; `naive`: with the composite of naive.mjs.
export function paintBefore(subject, view, all) {
  const eye = prepare(subject, view), ball = redBall(0.05 * view.camera.distance);
  ball.position.set(...view.camera.from).lerp(new Vector3(...view.camera.at), 0.5);
  subject.scene.add(ball);
  const shown = all.map(({ naive, clouds = true, ...settings }) => {
    const pass = passFor(subject, eye, view, settings), { composite } = pass.steps;
    if (naive) composite.fragmentShader = naiveOf(composite.fragmentShader);
    for (const mesh of subject.meshes) mesh.visible = clouds;
    return painted(pass, rendererOf(view.size));
  });
  for (const mesh of subject.meshes) mesh.visible = true;
  subject.scene.remove(ball);
  return shown;
}

// A red floor through the middle of the cloud.
export function paintCut(subject, view, settings) {
  const floor = new Mesh(new BoxGeometry(8, 0.01, 8), new MeshBasicMaterial({ color: 0xff0000 }));
  floor.position.set(...view.camera.at);
  subject.scene.add(floor);
  const shown = paint(subject, view, settings);
  subject.scene.remove(floor);
  return shown;
}

// The floor below a cloud that casts a shadow, or does not.
export function paintFloor(subject, view, casts) {
  const renderer = rendererOf(view.size), eye = prepare(subject, view), light = new DirectionalLight();
  const floor = new Mesh(new BoxGeometry(8, 0.1, 8), new MeshStandardMaterial());
  const { camera } = light.shadow, size = 2;
  Object.assign(camera, { left: -size, right: size, top: size, bottom: -size, near: 0.1, far: 20 });
  light.position.set(0, 5, 1);
  floor.position.y = -1;
  light.castShadow = floor.receiveShadow = true;
  for (const mesh of subject.meshes) mesh.castShadow = casts;
  Object.assign(renderer.shadowMap, { enabled: true, type: PCFShadowMap });
  subject.scene.add(light, floor);
  const shown = painted(passFor(subject, eye, view), renderer);
  subject.scene.remove(light, floor);
  renderer.shadowMap.enabled = false;
  light.dispose();
  return shown;
}

// What is not as it was after a picture: the next ordinary picture, the scene, the camera, the materials, and textures of the card.
export function changed(subject, view) {
  const renderer = rendererOf(view.size), eye = prepare(subject, view), { scene, meshes: [mesh], material } = subject;
  scene.background = new Color(0, 1, 0);
  subject.sky.visible = false;
  renderer.setClearColor(0x123456, 0.5);
  renderer.autoClear = false;
  const state = () => ({ background: scene.background.getHex(), camera: String(eye.projectionMatrix.elements),
    layers: [eye.layers.mask, mesh.layers.mask], writes: [material.colorWrite, material.depthWrite],
    own: [material.painted, renderer.autoClear, renderer.shadowMap.autoUpdate, renderer.getClearAlpha(),
      renderer.getClearColor(new Color()).getHex()], textures: renderer.info.memory.textures });
  const ordinary = () => {
    renderer.setRenderTarget(null);
    renderer.clear();
    renderer.render(scene, eye);
    return String(canvasOf(renderer));
  };
  const picture = ordinary(), before = state(), [red, green] = painted(passFor(subject, eye, view, { tone: 'renderer' }), renderer);
  const after = state(), again = ordinary();
  scene.background = null;
  subject.sky.visible = true;
  renderer.setClearColor(0, 1);
  renderer.autoClear = true;
  return { corner: [red, green], states: Object.keys(before).filter(key => JSON.stringify(before[key]) !== JSON.stringify(after[key])),
    picture: picture === again };
}
