// Clouds that cloudbake has baked, in Babylon.js. To import this module registers the loader extension "cloudbake".
import '@babylonjs/core/Shaders/ShadersInclude/bonesDeclaration.js';
import '@babylonjs/core/Shaders/ShadersInclude/bonesVertex.js';
import '@babylonjs/core/Shaders/ShadersInclude/fogFragment.js';
import '@babylonjs/core/Shaders/ShadersInclude/fogFragmentDeclaration.js';
import '@babylonjs/core/Shaders/ShadersInclude/fogVertex.js';
import '@babylonjs/core/Shaders/ShadersInclude/fogVertexDeclaration.js';
import '@babylonjs/core/Shaders/ShadersInclude/instancesDeclaration.js';
import '@babylonjs/core/Shaders/ShadersInclude/instancesVertex.js';
import '@babylonjs/core/Shaders/ShadersInclude/morphTargetsVertex.js';
import '@babylonjs/core/Shaders/ShadersInclude/morphTargetsVertexDeclaration.js';
import '@babylonjs/core/Shaders/ShadersInclude/morphTargetsVertexGlobal.js';
import '@babylonjs/core/Shaders/ShadersInclude/morphTargetsVertexGlobalDeclaration.js';
import { VertexBuffer } from '@babylonjs/core/Buffers/buffer.js';
import { Camera } from '@babylonjs/core/Cameras/camera.js';
import { BoundingInfo } from '@babylonjs/core/Culling/boundingInfo.js';
import { Constants } from '@babylonjs/core/Engines/constants.js';
import { ShaderMaterial } from '@babylonjs/core/Materials/shaderMaterial.js';
import { Texture } from '@babylonjs/core/Materials/Textures/texture.js';
import { Color3 } from '@babylonjs/core/Maths/math.color.js';
import { Vector2, Vector3, Vector4 } from '@babylonjs/core/Maths/math.vector.js';
import { Mesh } from '@babylonjs/core/Meshes/mesh.js';
import { VertexData } from '@babylonjs/core/Meshes/mesh.vertexData.js';
import { registerGLTFExtension } from '@babylonjs/loaders/glTF/2.0/glTFLoaderExtensionRegistry.js';
import { darkenLights, withoutComments } from './babylon_darken.js';
import { forwardOf } from './babylon_view.js';
import { DAY, DEFAULTS, SKY, addSoftSettings, cloudDefaults, impostorDefaults, impostorSettingsOf, settingsOf, shadowValues, skyDefaults,
  softValues, sunDefaults, switchPixelsOf } from './asset.js';
import { pixelsAcross, shownLevels, stretchedSides } from './levels.js';
import { CAST_SHADOW, CHANNELS, IMPOSTOR_PIXEL, IMPOSTOR_SQUARE, IMPOSTOR_VARYINGS, LAMPS, PIXEL_COLOR, SHADE, SKY_COLOR, SOFT, TONE,
  VARYINGS, vertexLight, writeVaryings } from './shaders.js';

// The name that the glTF loader gives to the attribute TEXCOORD_n.
const nameOfSet = n => n === 0 ? VertexBuffer.UVKind : `${VertexBuffer.UVKind}${n + 1}`;

const cloudVertex = names => `
precision highp float;
precision highp int;
attribute vec3 position;
attribute vec3 normal;
${names.map(name => `attribute vec2 ${name};`).join('\n')}
uniform mat4 view;
uniform mat4 viewProjection;
uniform vec3 eye;
uniform float is_perspective;
#include<bonesDeclaration>
#include<instancesDeclaration>
#include<morphTargetsVertexGlobalDeclaration>
#include<morphTargetsVertexDeclaration>[0..maxSimultaneousMorphTargets]
#include<fogVertexDeclaration>
uniform vec2 painted_place;  // of a sample in its pixel, on the screen, while PaintedClouds draws
${VARYINGS}
${vertexLight()}
#ifdef LAMPS
  ${LAMPS}
#endif
#ifdef CLOUD_SHADE
  ${SHADE}
  #ifdef INSTANCES
    attribute vec3 cloud_shade_shift;
  #else
    uniform vec3 cloud_shade_shift;
  #endif
#endif
void main() {
  vec3 positionUpdated = position;
  vec3 normalUpdated = normal;
  #include<morphTargetsVertexGlobal>
  #include<morphTargetsVertex>[0..maxSimultaneousMorphTargets]
  #include<instancesVertex>
  #include<bonesVertex>
  vec4 worldPos = finalWorld * vec4(positionUpdated, 1.0);
  gl_Position = viewProjection * worldPos;
  gl_Position.xy += painted_place * gl_Position.w;
  ${writeVaryings(names, 'normalUpdated', 'finalWorld', 'worldPos.xyz')}
  #ifdef CLOUD_SHADE
    cloud_light.x *= shadePastOthers(worldPos.xyz, cloud_shade_shift);
  #endif
  cloud_view = worldPos.xyz * is_perspective - eye;
  #include<fogVertex>
}
`;

const TO_SCREEN = `
  #ifdef OWN_TONE
    color.rgb = toneMap(color.rgb, exposure);
  #endif
`;

const CLOUD_FRAGMENT = `
precision highp float;
precision highp int;
#include<fogFragmentDeclaration>
${VARYINGS}
${PIXEL_COLOR}
${TONE}
${CHANNELS}
uniform vec2 painted_range;  // of depth, while PaintedClouds draws
uniform vec3 forward;
#ifdef SOFT
  ${SOFT}
  uniform float has_solid;
  uniform highp sampler2D solid_depth;  // distances along the view's axis
#endif
void main() {
  float away = dot(cloud_view, forward);
  vec2 light = cloud_light;
  #ifdef SOFT
    light *= insideFactor(cloud_normal, cloud_view);
    float solid = has_solid > 0.0 ? texelFetch(solid_depth, ivec2(gl_FragCoord.xy), 0).r : 1e30;
    if (opacityOfPixel(cloud_normal, cloud_view, cloud_place, away, solid) <= thresholdOfPixel()) discard;
  #endif
  if (painted_range.y > painted_range.x) {
    gl_FragColor = channelsOf(cloud_light, away, painted_range);
    return;
  }
  vec4 color = vec4(colorOfPixel(light, cloud_view), 1.0);
  #ifdef LAMPS
    color.rgb += cloud_lamps;
  #endif
  ${TO_SCREEN}
  #include<fogFragment>
  gl_FragColor = color;
}
`;

// The square is that of the file.
const IMPOSTOR_VERTEX = `
precision highp float;
precision highp int;
attribute vec3 position;
uniform mat4 view;
uniform mat4 viewProjection;
uniform vec3 eye;
uniform float is_perspective;
#include<instancesDeclaration>
#include<fogVertexDeclaration>
${IMPOSTOR_VARYINGS}
${IMPOSTOR_SQUARE}
void main() {
  #include<instancesVertex>
  vec2 corner = (position.xy - impostor_center.xy) / impostor_radius;
  vec4 worldPos = vec4(cornerInWorld(corner, finalWorld, eye, eye, is_perspective > 0.0), 1.0);
  gl_Position = viewProjection * worldPos;
  cloud_view = worldPos.xyz * is_perspective - eye;
  #include<fogVertex>
}
`;

const IMPOSTOR_FRAGMENT = `
precision highp float;
precision highp int;
#include<fogFragmentDeclaration>
${IMPOSTOR_VARYINGS}
${PIXEL_COLOR}
${TONE}
${IMPOSTOR_PIXEL}
void main() {
  vec3 light = impostorLight(to_sun);
  if (!(light.z > 0.0)) discard;
  vec4 color = vec4(colorOfPixel(light.xy, cloud_view), light.z);
  ${TO_SCREEN}
  #include<fogFragment>
  gl_FragColor = color;
}
`;

const SKY_VERTEX = `
precision highp float;
precision highp int;
attribute vec3 position;
uniform mat4 view;
uniform mat4 projection;
uniform float largest_depth;
varying vec3 sky_view;

void main() {
  gl_Position = vec4(position.xy, largest_depth, 1.0);
  sky_view = transpose(mat3(view)) * (inverse(projection) * vec4(position.xy, 0.0, 1.0)).xyz;
}
`;

const SKY_FRAGMENT = `
precision highp float;
precision highp int;
varying vec3 sky_view;
${SKY_COLOR}
${TONE}
void main() {
  vec4 color = vec4(colorOfSky(sky_view), 1.0);
  ${TO_SCREEN}
  gl_FragColor = color;
}
`;

const colorOf = rgb => Color3.FromArray(rgb);

/** @typedef {import('./babylon.d.ts').CloudSettings} Settings */

// What clouds and sky have in common: the sun, and the way to the screen's colours.
class SunlitMaterial extends ShaderMaterial {
  /** @type {Settings['sunLight']} */ sunLight;
  /** @type {Settings['sunColor']} */ sunColor;
  /** @type {Settings['exposure']} */ exposure;

  constructor(name, scene, vertexSource, fragmentSource, options) {
    super(name, scene, { vertexSource: withoutComments(vertexSource), fragmentSource: withoutComments(fragmentSource) }, options);
    this.sunDirection = Vector3.FromArray(DAY.sunDirection);
    Object.assign(this, sunDefaults(colorOf));
    this.tone = 'cloudbake';
  }

  get tone() { return this.options.defines.includes('OWN_TONE') ? 'cloudbake' : 'linear'; }
  set tone(name) { this.options.defines = [...this.options.defines.filter(word => word !== 'OWN_TONE'),
    ...name === 'cloudbake' ? ['OWN_TONE'] : []]; }

  // What each material has of its own.
  writeUniforms() {}

  // Babylon.js calls it before each mesh that it draws with the material.
  bind(world, mesh, effectOverride, subMesh) {
    const { sunLight } = this;
    if (sunLight)
      (sunLight.computeTransformedInformation() ? sunLight.transformedDirection : sunLight.direction).scaleToRef(-1, this.sunDirection);
    this.setVector3('to_sun', this.sunDirection.normalizeToNew());
    this.setFloat('exposure', this.exposure);
    this.writeUniforms();
    super.bind(world, mesh, effectOverride, subMesh);
  }
}

// What sets each field of a lamp of lamp.glsl.
const LAMP_SETTERS = { place: 'setVector3', color: 'setColor3', range: 'setFloat', radius: 'setFloat', axis: 'setVector3',
  cone: 'setVector2' };

// A PointLight or a SpotLight as such a lamp.
function lampOf(light) {
  light.computeTransformedInformation();
  const { diffuse, intensity, range, angle, innerAngle = 0 } = light;
  return {
    place: light.getAbsolutePosition(), color: diffuse.scale(intensity), range: range < Number.MAX_VALUE ? range : 0,
    radius: light.radius, axis: (light.transformedDirection ?? light.direction ?? Vector3.Zero()).normalizeToNew(),
    cone: angle === undefined ? new Vector2(-1, -1) : new Vector2(Math.cos(innerAngle / 2), Math.cos(angle / 2)),
  };
}

export class CloudMaterial extends SunlitMaterial {
  /** @type {Settings['ambientSky']} */ ambientSky;
  /** @type {Settings['ambientGround']} */ ambientGround;
  /** @type {Settings['exponent']} */ exponent;
  /** @type {Settings['densityMax']} */ densityMax;
  /** @type {Settings['bias']} */ bias;
  /** @type {Settings['extinction']} */ extinction;
  /** @type {Settings['halfLambert']} */ halfLambert;
  /** @type {Settings['flipV']} */ flipV;
  /** @type {Settings['ofVolume']} */ ofVolume;
  /** @type {Settings['depthTexture']} */ depthTexture;
  switchPixels = 0;  // of a level of detail
  /** @type {any} */ painted = null;  // what PaintedClouds needs while it draws
  /** @type {any} */ shade = null;

  constructor(name, scene, parameters = {}) {
    const { uvSets = DEFAULTS.uvSets, ...others } = parameters, names = uvSets.map(nameOfSet);
    super(name, scene, cloudVertex(names), CLOUD_FRAGMENT, {
      attributes: ['position', 'normal', ...names, 'cloud_shade_shift'], defines: ['NORMAL'],
      uniforms: ['world', 'view', 'viewProjection', 'eye', 'is_perspective', 'to_sun', 'exposure', 'sun_color',
        'ambient_sky', 'ambient_ground', 'shape', 'extinction', 'density_max',
        'half_lambert', 'volume_gain', 'flipped', 'phase', 'forward', 'painted_range', 'painted_place', 'has_solid',
        'cloud_shade_rows', 'cloud_shade_shift', ...Object.keys(softValues({}))],
      samplers: ['solid_depth', 'cloud_shades'],
    });
    Object.assign(this, cloudDefaults(colorOf), { uvSets }, others);
  }

  getClassName() { return 'CloudMaterial'; }

  get phase() { return this.scattering; }
  set phase(given) { this.scattering = { ...DAY.phase, ...given }; }

  get lamps() { return this.lampList; }
  set lamps(lights) {
    const { options } = this, names = Object.keys(LAMP_SETTERS), count = lights.length > 0 ? [`LAMPS ${lights.length}`] : [];
    options.defines = [...options.defines.filter(word => !word.startsWith('LAMPS')), ...count];
    options.uniforms = [...options.uniforms.filter(name => !name.startsWith('lamps[')),
      ...lights.flatMap((_, i) => names.map(name => `lamps[${i}].${name}`))];
    this.lampList = lights;
  }

  get soft() { return this.options.defines.includes('SOFT'); }
  set soft(is_soft) { this.options.defines = [...this.options.defines.filter(word => word !== 'SOFT'), ...is_soft ? ['SOFT'] : []]; }

  // The CloudShade that shades the clouds of the material; null: none does.
  get cloudShade() { return this.shade; }
  set cloudShade(shade) {
    this.shade = shade;
    this.options.defines = [...this.options.defines.filter(word => word !== 'CLOUD_SHADE'), ...shade ? ['CLOUD_SHADE'] : []];
  }

  bind(world, mesh, effectOverride, subMesh) {
    super.bind(world, mesh, effectOverride, subMesh);
    // Meshes that follow each other share the other uniforms.
    const effect = effectOverride ?? subMesh?.effect ?? this.getEffect();
    if (this.soft) effect.setArray2('shown', mesh?.metadata?.cloudShown ?? [0, 1]);
    this.shade?.bind(effect, subMesh?.getMesh() ?? mesh);
  }

  writeUniforms() {
    const camera = this.getScene().activeCamera, is_perspective = camera.mode === Camera.PERSPECTIVE_CAMERA, forward = forwardOf(camera);
    this.setVector3('eye', is_perspective ? camera.globalPosition : forward.scale(-1));
    this.setFloat('is_perspective', is_perspective ? 1 : 0);
    this.setColor3('sun_color', this.sunColor);
    this.setColor3('ambient_sky', this.ambientSky);
    this.setColor3('ambient_ground', this.ambientGround);
    this.setVector2('shape', new Vector2(this.exponent, this.bias));
    this.setFloat('extinction', this.extinction);
    this.setFloat('density_max', this.densityMax);
    this.setFloat('half_lambert', this.painted?.halfLambert ?? this.halfLambert);
    this.setFloat('volume_gain', this.ofVolume ? this.painted?.volumeGain ?? 1 : 1);
    this.setVector3('forward', forward);
    this.setArray2('painted_range', this.painted?.depthRange ?? [0, 0]);
    this.setArray2('painted_place', this.painted?.place ?? [0, 0]);
    this.lamps.forEach((light, i) => {
      for (const [name, value] of Object.entries(lampOf(light))) this[LAMP_SETTERS[name]](`lamps[${i}].${name}`, value);
    });
    if (this.soft) this.writeSoft();
    this.setFloat('flipped', this.flipV ? 1 : 0);
    this.setVector3('phase', new Vector3(this.phase.share, this.phase.asymmetry, this.phase.limit));
  }

  writeSoft() {
    const setters = { 1: 'setFloat', 2: 'setArray2', 3: 'setArray3' }, depth = this.painted ? null : this.depthTexture;
    for (const [name, value] of Object.entries(softValues(this, this.painted))) this[setters[value.length ?? 1]](name, value);
    this.setFloat('has_solid', depth ? 1 : 0);
    if (depth) this.setTexture('solid_depth', depth);
    else this.removeTexture('solid_depth');
  }
}
addSoftSettings(CloudMaterial);

// For the square of an impostor (`cloudbake impostor`), which it turns to the camera.
export class ImpostorMaterial extends SunlitMaterial {
  /** @type {Settings['ambientSky']} */ ambientSky;
  /** @type {Settings['ambientGround']} */ ambientGround;
  /** @type {number} */ exponent;
  /** @type {number} */ extinction;
  /** @type {boolean} */ ofVolume;
  /** @type {number} */ volumeGain;
  /** @type {number[]} */ center;
  /** @type {number} */ radius;
  /** @type {number[]} */ atlas;
  /** @type {Texture | null} */ lobeTexture;
  /** @type {Texture | null} */ restTexture;

  constructor(name, scene, parameters = {}) {
    super(name, scene, IMPOSTOR_VERTEX, IMPOSTOR_FRAGMENT, {
      attributes: ['position'], needAlphaBlending: true, samplers: ['impostor_lobe', 'impostor_rest'],
      uniforms: ['world', 'view', 'viewProjection', 'eye', 'is_perspective', 'to_sun', 'exposure', 'sun_color', 'ambient_sky',
        'ambient_ground', 'extinction', 'volume_gain', 'phase', 'impostor_atlas', 'impostor_center', 'impostor_radius', 'impostor_scale',
        'impostor_exponent'],
    });
    this.backFaceCulling = false;
    this.disableDepthWrite = true;
    Object.assign(this, impostorDefaults(colorOf), parameters);
  }

  getClassName() { return 'ImpostorMaterial'; }

  get phase() { return this.scattering; }
  set phase(given) { this.scattering = { ...DAY.phase, ...given }; }

  writeUniforms() {
    const scene = this.getScene(), camera = scene.activeCamera, is_perspective = camera.mode === Camera.PERSPECTIVE_CAMERA;
    this.setVector3('eye', is_perspective ? camera.globalPosition : forwardOf(camera).scale(-1));
    this.setFloat('is_perspective', is_perspective ? 1 : 0);
    this.setColor3('sun_color', this.sunColor);
    this.setColor3('ambient_sky', this.ambientSky);
    this.setColor3('ambient_ground', this.ambientGround);
    this.setFloat('extinction', this.extinction);
    this.setFloat('volume_gain', this.ofVolume ? this.volumeGain : 1);
    this.setVector3('phase', new Vector3(this.phase.share, this.phase.asymmetry, this.phase.limit));
    this.setVector4('impostor_atlas', Vector4.FromArray(this.atlas));
    this.setVector3('impostor_center', Vector3.FromArray(this.center));
    this.setFloat('impostor_radius', this.radius);
    this.setFloat('impostor_scale', 2 / (camera.getProjectionMatrix().m[5] * scene.getEngine().getRenderHeight()));
    this.setFloat('impostor_exponent', this.exponent);
    this.setTexture('impostor_lobe', this.lobeTexture);
    this.setTexture('impostor_rest', this.restTexture);
  }
}

// For a mesh that covers the screen, which createCloudSky makes, and cameras with perspective.
export class SkyMaterial extends SunlitMaterial {
  constructor(name, scene, parameters = {}) {
    super(name, scene, SKY_VERTEX, SKY_FRAGMENT, {
      attributes: ['position'], uniforms: ['view', 'projection', 'to_sun', 'exposure', ...Object.values(SKY), 'sun_color', 'largest_depth'],
    });
    this.backFaceCulling = false;
    Object.assign(this, skyDefaults(colorOf), parameters);
  }

  getClassName() { return 'SkyMaterial'; }

  writeUniforms() {
    for (const [name, uniform] of Object.entries(SKY)) this.setColor3(uniform, this[name]);
    this.setColor3('sun_color', this.sunColor);
    this.setFloat('largest_depth', this.getScene().getEngine().useReverseDepthBuffer ? -1 : 1);
  }
}

// The sky behind everything else of a scene: a triangle that covers the screen at the largest depth.
export function createCloudSky(scene, material = new SkyMaterial('sky', scene)) {
  const mesh = new Mesh('sky', scene), data = new VertexData();
  data.positions = [-1, -1, 0, 3, -1, 0, -1, 3, 0];
  data.indices = [0, 1, 2];
  data.applyToMesh(mesh);
  mesh.material = material;
  mesh.alwaysSelectAsActiveMesh = true;
  mesh.isPickable = false;
  return mesh;
}

// The material of the meshes that a loaded file has lobes in, or null: cloudMaterialOf(result.meshes).
export function cloudMaterialOf(meshes) {
  return meshes.map(({ material }) => material).find(material => material instanceof CloudMaterial) ?? null;
}

// That of an impostor, or null.
export function impostorMaterialOf(meshes) {
  return meshes.map(({ material }) => material).find(material => material instanceof ImpostorMaterial) ?? null;
}

// A picture of an atlas, from the bytes of its PNG.
function atlasTexture(bytes, scene) {
  const url = URL.createObjectURL(new Blob([bytes], { type: 'image/png' }));
  return new Promise((done, fail) => {
    const texture = new Texture(url, scene, { invertY: false, samplingMode: Texture.TRILINEAR_SAMPLINGMODE,
      onLoad: () => { URL.revokeObjectURL(url); done(texture); }, onError: fail });
    texture.wrapU = texture.wrapV = Constants.TEXTURE_CLAMP_ADDRESSMODE;
    texture.anisotropicFilteringLevel = 1;
  });
}

// Meshes of baked files are drawn with one CloudMaterial, the square of an impostor with an ImpostorMaterial.
class CloudbakeExtension {
  constructor(loader) {
    this.name = 'cloudbake';
    this.enabled = true;
    this.loader = loader;
  }

  dispose() { this.loader = null; }

  loadSceneAsync(context, scene) {
    const impostor = impostorSettingsOf(this.loader.gltf);
    return impostor && this.loader.loadSceneAsync(context, scene).then(() => this.makeImpostor(impostor));
  }

  async makeImpostor({ textures, ...settings }) {
    const { gltf, babylonScene, rootBabylonMesh } = this.loader, { center, radius } = settings;
    const [lobeTexture, restTexture] = await Promise.all([textures.lobe, textures.rest].map(async number => {
      const { bufferView } = gltf.images[gltf.textures[number].source];
      return atlasTexture(await this.loader.loadBufferViewAsync(`/bufferViews/${bufferView}`, gltf.bufferViews[bufferView]), babylonScene);
    }));
    const material = new ImpostorMaterial('impostor', babylonScene, { ...settings, lobeTexture, restTexture });
    for (const mesh of rootBabylonMesh.getChildMeshes(false, one => one instanceof Mesh && one.getTotalVertices() > 0)) {
      mesh.material = material;
      const corner = reach => Vector3.FromArray(center.map(x => x + reach));
      mesh.setBoundingInfo(new BoundingInfo(corner(-radius), corner(radius)));
    }
  }

  onReady() {
    const { gltf, babylonScene, rootBabylonMesh } = this.loader, settings = settingsOf(gltf);
    if (!settings) return;
    const names = settings.uvSets.map(nameOfSet);
    const meshes = rootBabylonMesh.getChildMeshes(false, mesh =>
      mesh instanceof Mesh && names.every(name => mesh.isVerticesDataPresent(name)));
    if (!meshes.length) return;
    const material = new CloudMaterial('cloud', babylonScene, settings);
    material.switchPixels = switchPixelsOf(gltf);
    material.backFaceCulling = meshes.every(mesh => mesh.material?.backFaceCulling ?? true);
    for (const mesh of meshes) {
      if (!mesh.isVerticesDataPresent(VertexBuffer.NormalKind)) mesh.createNormals(false);
      mesh.material = material;
    }
  }
}

// The levels of detail of a cloud (`cloudbake bake --lods`), from the containers of their files, the full asset first. They switch by the
// size on the screen where a camera draws them, as `cloudbake preview` does.
export class CloudLevels {
  constructor(containers, scene, { switchBand = 0.3 } = {}) {
    this.scene = scene;
    this.switchBand = switchBand;
    this.levels = containers.map(({ meshes }) => meshes.filter(({ material }) => material instanceof CloudMaterial));
    for (const mesh of this.levels.flat()) {
      mesh.material.soft = true;
      mesh.metadata = { ...mesh.metadata };
    }
    this.observer = scene.onBeforeCameraRenderObservable.add(camera => this.update(camera), undefined, true);
  }

  update(camera) {
    const boxes = this.levels[0].map(mesh => {
      mesh.computeWorldMatrix();
      return mesh.getBoundingInfo().boundingBox;
    });
    const corner = (least, name) => ['x', 'y', 'z'].map(axis => least(...boxes.map(box => box[name][axis])));
    const longest = Math.max(0, ...boxes.map(({ extendSize }, i) =>
      2 * stretchedSides(extendSize.asArray(), this.levels[0][i].getWorldMatrix().m)));
    const pixels = pixelsAcross(longest, corner(Math.min, 'minimumWorld'), corner(Math.max, 'maximumWorld'),
      camera.globalPosition.asArray(), 1 / camera.getProjectionMatrix().m[5], this.scene.getEngine().getRenderHeight());
    const shown = shownLevels(pixels, this.levels.map(([{ material }]) => material.switchPixels), this.switchBand);
    this.levels.forEach((meshes, i) => {
      for (const mesh of meshes) {
        mesh.isVisible = shown[i] !== null;
        mesh.metadata.cloudShown = shown[i] ?? [0, 1];
      }
    });
  }

  dispose() { this.scene.onBeforeCameraRenderObservable.remove(this.observer); }
}

// The shadow of a cloud that `cloudbake shadow` wrote, SHADOW.png, and SHADOW.json with its frame.
export class CloudShadow {
  constructor(texture, frame, strength = 1) {
    this.texture = texture;
    this.frame = frame;
    this.shadowStrength = strength;
    texture.wrapU = texture.wrapV = Constants.TEXTURE_CLAMP_ADDRESSMODE;
    texture.anisotropicFilteringLevel = 1;  // which needs levels of the texture to be right
  }

  static async load(picture, scene, strength = 1) {
    const answer = await fetch(picture.replace(/\.png$/, '.json'));
    if (!answer.ok) throw new Error(`${picture} has no frame beside it: ${answer.url} answers ${answer.status}; copy both files`);
    const texture = new Texture(picture, scene, { noMipmap: true });
    return new CloudShadow(texture, await answer.json(), strength);
  }

  // A StandardMaterial or a PBRMaterial gets the shadow: its direct light is darkened. The frame is in the axes of glTF, which a
  // left-handed scene mirrors.
  darken(material) {
    const uniforms = ['shadow_origin', 'shadow_right', 'shadow_up', 'shadow_to_sun', 'shadow_share', 'shadow_mirror'];
    return darkenLights(material, { name: 'cloud_shadow', text: `${CAST_SHADOW}\nuniform vec3 shadow_mirror;`,
      share: 'castShadow(shadow_mirror * vPositionW)', uniforms, texture: 'cloud_shadow', bind: (effect, scene) => {
        for (const [name, value] of Object.entries(shadowValues(this.frame, this.shadowStrength))) effect.setFloat3(name, ...value);
        effect.setFloat3('shadow_mirror', scene.useRightHandedSystem ? 1 : -1, 1, 1);
        effect.setTexture('cloud_shadow', this.texture);
      } });
  }
}

registerGLTFExtension('cloudbake', false, loader => new CloudbakeExtension(loader));
