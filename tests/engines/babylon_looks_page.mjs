// Draws triangles and assets with settings of CloudMaterial in Babylon.js, for looks.mjs.
import { FreeCamera } from '@babylonjs/core/Cameras/freeCamera.js';
import { Constants } from '@babylonjs/core/Engines/constants.js';
import { DirectionalLight } from '@babylonjs/core/Lights/directionalLight.js';
import { PointLight } from '@babylonjs/core/Lights/pointLight.js';
import { SpotLight } from '@babylonjs/core/Lights/spotLight.js';
import { LoadAssetContainerAsync } from '@babylonjs/core/Loading/sceneLoader.js';
import { PBRMaterial } from '@babylonjs/core/Materials/PBR/pbrMaterial.js';
import { StandardMaterial } from '@babylonjs/core/Materials/standardMaterial.js';
import { RawTexture } from '@babylonjs/core/Materials/Textures/rawTexture.js';
import { RenderTargetTexture } from '@babylonjs/core/Materials/Textures/renderTargetTexture.js';
import { Color3, Color4 } from '@babylonjs/core/Maths/math.color.js';
import { Vector3 } from '@babylonjs/core/Maths/math.vector.js';
import { CreateGround } from '@babylonjs/core/Meshes/Builders/groundBuilder.js';
import { Mesh } from '@babylonjs/core/Meshes/mesh.js';
import { VertexData } from '@babylonjs/core/Meshes/mesh.vertexData.js';
import { Scene } from '@babylonjs/core/scene.js';
import { CloudLevels, CloudMaterial, CloudShadow } from 'cloudbake-materials/babylon';
import { PaintedClouds } from 'cloudbake-materials/babylon/painted';
import { CloudShade } from 'cloudbake-materials/babylon/shade';
import { changesOf } from './changes.mjs';
import { canvasOf, colorOf, draw, engineOf, nextFrame, ready } from './babylon_page.mjs';

export { describe, draw, load } from './babylon_page.mjs';

// The 8 bits of draw(), by the curve of `preview`.
export async function drawInBits(subject, view) {
  const film = x => Math.min(1, x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14));
  const bits = x => Math.round(255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055));
  return Array.from(await draw(subject, view), x => bits(film(x)));
}

function lightsOf(lamps, scene) {
  return lamps.map(({ place, color, strength, range, axis, angles, radius }) => {
    const at = new Vector3(...place), light = axis ? new SpotLight('lamp', at, new Vector3(...axis), 2 * angles[1], 1, scene)
      : new PointLight('lamp', at, scene);
    Object.assign(light, { diffuse: new Color3(...color), intensity: strength, radius });
    if (range) light.range = range;
    if (axis) light.innerAngle = 2 * angles[0];
    return light;
  });
}

function sceneOf([width, height], fov) {
  const engine = engineOf([width, height]), scene = new Scene(engine);
  scene.useRightHandedSystem = true;  // before there is a camera
  const eye = new FreeCamera('eye', Vector3.Zero(), scene);
  scene.clearColor = new Color4(0, 0, 0, 0);
  Object.assign(eye, { fov: fov * Math.PI / 180, minZ: 0.1, maxZ: 1000 });
  eye.setTarget(new Vector3(0, 0, -1));
  return { scene, eye };
}

// The linear RGBA of the scene, rows from the top.
async function valuesOf(scene, eye, [width, height]) {
  const target = new RenderTargetTexture('target', { width, height }, scene,
    { type: Constants.TEXTURETYPE_FLOAT, generateMipMaps: false, samplingMode: Constants.TEXTURE_NEAREST_SAMPLINGMODE });
  eye.outputRenderTarget = target;
  scene.render();  // makes what the target needs
  await ready(scene);
  scene.render();
  const rows = await target.readPixels();
  eye.outputRenderTarget = null;
  target.dispose();
  return Float32Array.from(rows, (_, i) =>
    rows[4 * (width * (height - 1 - Math.floor(i / 4 / width)) + Math.floor(i / 4) % width) + i % 4]);
}

export async function drawFlat({ size, fov, triangle: { places, normals, lobe }, lamps = [], solid, settings }) {
  const { scene, eye } = sceneOf(size, fov), black = new Color3(0, 0, 0), ambient = lamps.length ? black : new Color3(0.5, 0.5, 0.5);
  const material = new CloudMaterial('cloud', scene, { uvSets: [0, 1], sunColor: black, ambientSky: ambient, ambientGround: ambient,
    tone: 'linear', ...settings });
  const mesh = new Mesh('triangle', scene), data = new VertexData();
  material.lamps = lightsOf(lamps, scene);
  if (solid) {
    const distances = new Float32Array(size[0] * size[1]).fill(solid);
    material.depthTexture = RawTexture.CreateRTexture(distances, ...size, scene, false, false, Constants.TEXTURE_NEAREST_SAMPLINGMODE,
      Constants.TEXTURETYPE_FLOAT);
  }
  Object.assign(data, { positions: places.flat(), normals: normals.flat(), indices: [0, 1, 2],
    uvs: places.flatMap(() => lobe.slice(0, 2)), uvs2: places.flatMap(() => lobe.slice(2)) });
  data.applyToMesh(mesh);
  mesh.material = material;
  material.backFaceCulling = false;
  const values = await valuesOf(scene, eye, size);
  scene.dispose();
  return values;
}

// The shade of the grid of a cloud.
async function shadeOfCloud(file, scene, sun) {
  const { meshes: [root] } = await LoadAssetContainerAsync(file, scene), shade = new CloudShade(scene).add(root);
  shade.update(new Vector3(...sun));
  return shade;
}

export async function shadowAt({ picture, cloud, strength, places, sun, physical }) {
  const ratio = [];
  for (const shaded of [false, true]) {
    const size = [65, 65], { scene, eye } = sceneOf(size, 60), floor = CreateGround('floor', { width: 50, height: 50 }, scene);
    const light = new DirectionalLight('sun', new Vector3(...sun).scale(-1), scene), Material = physical ? PBRMaterial : StandardMaterial;
    const look = physical ? { metallic: 0, roughness: 1 } : { specularColor: Color3.Black() };
    floor.material = Object.assign(new Material('floor', scene), look);
    light.intensity = 0.5;
    if (shaded) (await (cloud ? shadeOfCloud(cloud, scene, sun) : CloudShadow.load(picture, scene, strength))).darken(floor.material);
    const values = [];
    for (const [x, y, z] of places) {
      floor.position.y = y;
      eye.position.set(x, y + 6, z + 6);
      eye.setTarget(new Vector3(x, y, z));
      values.push((await valuesOf(scene, eye, size))[4 * (65 * 32 + 32)]);
    }
    scene.dispose();
    ratio.push(values);
  }
  return ratio[1].map((value, i) => (value / ratio[0][i]) ** (physical ? 2.2 : 1));  // a PBRMaterial writes the colours of a screen
}

export async function drawLevels({ files, size, at, distances, longest, switchBand, single = false, painted = false, clear }) {
  const { scene, eye } = sceneOf(size, 35), containers = [];
  for (const file of single ? files.slice(0, 1) : files) containers.push(await LoadAssetContainerAsync(file, scene));
  for (const container of containers) container.addAllToScene();
  scene.clearColor = Color4.FromColor3(colorOf(clear));
  const levels = new CloudLevels(containers, scene, { switchBand });
  const look = painted ? new PaintedClouds('painted', scene, eye, { size: longest, swirl: { strength: 0 } }) : null;
  const pictures = [], shown = [];
  for (const away of distances) {
    eye.position.set(at[0] + 0.3 * away, at[1] + 0.2 * away, at[2] + away);
    eye.setTarget(new Vector3(...at));
    await ready(scene);
    do {
      scene.render();
      await nextFrame();
    } while (look && !look.isReady());
    scene.render();
    pictures.push(canvasOf(size));
    shown.push(levels.levels.map(([mesh]) => mesh.isVisible));
  }
  scene.dispose();
  return { changes: changesOf(pictures), shown };
}
