// A program that uses all types of the package; web.mjs compiles it.
import { Color, DirectionalLight, DoubleSide, InstancedMesh, Mesh, MeshStandardMaterial, PerspectiveCamera, PointLight, Scene, SpotLight,
  Vector3, WebGLRenderer } from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { EffectComposer } from 'three/addons/postprocessing/EffectComposer.js';
import { CloudLevels, CloudMaterial, CloudShadow, CloudSky, CloudbakeLoaderPlugin, ImpostorMaterial, SkyMaterial, impostorSquare,
  sortImpostors } from 'cloudbake-materials/three';
import { PaintedClouds } from 'cloudbake-materials/three/painted';
import { CloudSequence } from 'cloudbake-materials/three/sequence';
import { CloudSequence as BabylonSequence } from 'cloudbake-materials/babylon/sequence';
import { CloudShade } from 'cloudbake-materials/three/shade';
import { Color3 } from '@babylonjs/core/Maths/math.color.js';
import { Vector3 as BabylonVector3 } from '@babylonjs/core/Maths/math.vector.js';
import { DirectionalLight as BabylonLight } from '@babylonjs/core/Lights/directionalLight.js';
import { LoadAssetContainerAsync } from '@babylonjs/core/Loading/sceneLoader.js';
import type { AssetContainer } from '@babylonjs/core/assetContainer.js';
import type { Scene as BabylonScene } from '@babylonjs/core/scene.js';
import type { Camera } from '@babylonjs/core/Cameras/camera.js';
import type { StandardMaterial } from '@babylonjs/core/Materials/standardMaterial.js';
import { PaintedClouds as BabylonPainted } from 'cloudbake-materials/babylon/painted';
import { CloudShade as BabylonShade } from 'cloudbake-materials/babylon/shade';
import * as babylon from 'cloudbake-materials/babylon';

export async function inThree(scene: Scene, light: DirectionalLight): Promise<CloudMaterial> {
  const loader = new GLTFLoader().register(parser => new CloudbakeLoaderPlugin(parser,
    { sunLight: light, phase: { share: 0.45 }, side: DoubleSide }));
  const gltf = await loader.loadAsync('cloud.glb');
  const material: CloudMaterial = gltf.userData.cloudMaterial;
  material.sunDirection = new Vector3(0, 1, 0);
  material.ambientSky.set('skyblue');
  material.tone = 'cloudbake';
  material.extinction *= 2;
  material.harmonicOrder = 0;
  const other = new CloudMaterial({ sunColor: 0xffeecc, exponent: 4, bias: 0, uvSets: [1, 2], flipV: true,
    halfLambert: 1, fog: false, harmonicOrder: 2, harmonicExtinction: 3 }).clone();
  scene.add(gltf.scene, new CloudSky(new SkyMaterial({ zenith: new Color(0, 0, 1), exposure: 2 })),
    new InstancedMesh(new Mesh().geometry, other, 10));
  return material;
}

export async function farAway(scene: Scene, loader: GLTFLoader, camera: PerspectiveCamera): Promise<ImpostorMaterial> {
  const gltf = await loader.loadAsync('far/impostor.glb');
  const material: ImpostorMaterial = gltf.userData.impostorMaterial;
  material.extinction *= 2;
  material.phase = { ...material.phase, share: 0.45 };
  const { lobeTexture, restTexture, center, radius, atlas } = material;
  const other = new ImpostorMaterial({ lobeTexture, restTexture, center, radius, atlas, sunColor: 0xffeecc, phase: { share: 0.3 } });
  const many = new InstancedMesh(impostorSquare(other), other, 100);
  sortImpostors(many, camera);
  scene.add(gltf.scene, many);
  return material;
}

export function farInBabylon(container: AssetContainer): babylon.ImpostorMaterial | null {
  const material = babylon.impostorMaterialOf(container.meshes);
  if (material) Object.assign(material, { sunLight: null, phase: { share: 0.45 }, volumeGain: 1.4 });
  return material;
}

export function painted(renderer: WebGLRenderer, scene: Scene, camera: PerspectiveCamera, composer: EffectComposer): PaintedClouds {
  const clouds = new PaintedClouds(scene, camera,
    { tone: 'cloudbake', samplesPerSide: 4, swirl: { seed: 1 }, fogColor: new Color(1, 1, 1) });
  composer.addPass(clouds);
  clouds.time += 0.1;
  clouds.erosion.shrink = 0.5;
  clouds.size = null;
  clouds.render(renderer);
  clouds.render(renderer, clouds.behind);
  clouds.dispose();
  return clouds;
}

export async function softly(scene: Scene, loader: GLTFLoader, material: CloudMaterial): Promise<MeshStandardMaterial> {
  Object.assign(material, { rimStart: 0, rimEnd: 0.4, rimFrequency: 3, side: DoubleSide });
  material.rimScroll = [0.1, 0, 0];
  material.softDistance = 0.2;
  material.depthTexture = null;
  material.nearFade = [0.1, 0.5];
  material.lamps = [new PointLight('white', 3), new SpotLight()];
  const files = await Promise.all(['cloud.glb', 'cloud_lod1.glb'].map(file => loader.loadAsync(file)));
  const levels = new CloudLevels(files, { switchBand: 0.2 });
  levels.pictureHeight = 1080;
  scene.add(levels);
  const shadow = await CloudShadow.load('shadow.png');
  shadow.shadowStrength = 0.8;
  shadow.update();
  return shadow.darken(new MeshStandardMaterial());
}

export async function changing(scene: Scene, loader: GLTFLoader, seconds: number): Promise<CloudSequence> {
  const smoke = await CloudSequence.of(await loader.loadAsync('smoke.glb')), other = smoke.clone();
  smoke.update(seconds % smoke.duration);
  smoke.material.extinction *= 2;
  other.position.set(1, 0, 0);
  other.update(0);
  scene.add(smoke, other);
  other.dispose();
  return smoke;
}

export async function changingInBabylon(scene: BabylonScene, seconds: number): Promise<BabylonSequence> {
  const smoke = await BabylonSequence.load('smoke.glb', scene), other = smoke.copy();
  smoke.update(seconds % smoke.duration);
  smoke.material.extinction *= 2;
  other.position.x = 1;
  other.update(0);
  other.dispose();
  return smoke;
}

export function shaded(scene: Scene, sun: Vector3, ground: MeshStandardMaterial): CloudShade {
  const shade = new CloudShade({ strength: 0.9 }).add(scene).remove(new Mesh());
  shade.shadeStrength = shade.darken(ground).roughness;
  shade.update(sun);
  shade.dispose();
  return shade;
}

export function shadedInBabylon(scene: BabylonScene, { meshes: [root] }: AssetContainer, ground: StandardMaterial): BabylonShade {
  const shade = new BabylonShade(scene, { strength: 0.9 }).add(root!).remove(root!);
  shade.shadeStrength = shade.darken(ground).alpha;
  shade.update(new BabylonVector3(0, 1, 0));
  shade.dispose();
  return shade;
}

export async function paintedInBabylon(scene: BabylonScene, camera: Camera, ground: StandardMaterial): Promise<BabylonPainted> {
  const painted = new BabylonPainted('painted', scene, camera, { resolution: 0.5, swirl: { seed: 1 }, nearFade: [0.1, 1], tone: 'linear' });
  painted.farFade = [50, 90];
  painted.fogColor = new Color3(1, 1, 1);
  if (!painted.isReady()) painted.post.samples = 1;
  const levels = new babylon.CloudLevels([await LoadAssetContainerAsync('cloud.glb', scene)], scene);
  levels.switchBand = 0.2;
  (await babylon.CloudShadow.load('shadow.png', scene, 0.5)).darken(ground);
  levels.dispose();
  painted.dispose();
  return painted;
}

export async function inBabylon(scene: BabylonScene): Promise<babylon.CloudMaterial | null> {
  const container = await LoadAssetContainerAsync('cloud.glb', scene);
  container.addAllToScene();
  const material = babylon.cloudMaterialOf(container.meshes);
  if (!material) return null;
  material.sunLight = new BabylonLight('sun', new BabylonVector3(0, -1, 0), scene);
  material.phase = { share: 0.45 };
  material.ambientGround = new Color3(0, 0, 0);
  const sky: babylon.SkyMaterial = new babylon.SkyMaterial('sky', scene, { sunLight: material.sunLight, tone: 'linear' });
  babylon.createCloudSky(scene, sky).isPickable = true;
  return new babylon.CloudMaterial('other', scene, { uvSets: [0, 1], phase: { limit: 3 }, extinction: 2 });
}

export const clouds = { material: new CloudMaterial() };
