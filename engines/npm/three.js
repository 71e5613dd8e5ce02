// Clouds that cloudbake has baked, in three.js (WebGLRenderer).
import { Box3, BufferAttribute, BufferGeometry, ClampToEdgeWrapping, Color, DoubleSide, LOD, LinearFilter, LinearMipmapLinearFilter,
  Matrix3, Matrix4, Mesh, NoColorSpace, ShaderMaterial, Sphere, TextureLoader, UniformsLib, UniformsUtils, Vector2, Vector3,
  Vector4 } from 'three';
import { DAY, SKY, SOFT_NAMES, addSoftSettings, cloudDefaults, impostorDefaults, impostorSettingsOf, settingsOf, skyDefaults, shadowValues,
  softValues, sunDefaults, switchPixelsOf } from './asset.js';
import { pixelsAcross, shownLevels, stretchedSides } from './levels.js';
import { CAST_SHADOW, CHANNELS, IMPOSTOR_PIXEL, IMPOSTOR_SQUARE, IMPOSTOR_VARYINGS, LAMPS, PIXEL_COLOR, SHADE, SKY_COLOR, SOFT, TONE,
  VARYINGS, harmonicNames, vertexLight, writeVaryings } from './shaders.js';
import { darkenLights } from './three_darken.js';
import { SOLID_DISTANCE } from './three_depth.js';

const TO_WORLD = `mat4 to_world = modelMatrix;
  #ifdef USE_INSTANCING
    to_world *= instanceMatrix;
  #endif
  #ifdef USE_BATCHING
    to_world *= batchingMatrix;
  #endif`;

// The name that GLTFLoader gives to the attribute TEXCOORD_n.
const nameOfSet = n => n === 0 ? 'uv' : n < 4 ? `uv${n}` : `texcoord_${n}`;

const cloudVertex = (names, order) => `
#include <common>
#include <batching_pars_vertex>
#include <fog_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
${names.filter(name => name !== 'uv').map(name => `attribute vec2 ${name};`).join('\n')}
${VARYINGS}
${vertexLight(order)}
#ifdef LAMPS
  ${LAMPS}
#endif
#ifdef CLOUD_SHADE
  ${SHADE}
  #ifdef USE_INSTANCING
    attribute vec3 cloud_shade_shift;
  #else
    uniform vec3 cloud_shade_shift;
  #endif
#endif
void main() {
  #include <morphinstance_vertex>
  #include <batching_vertex>
  #include <beginnormal_vertex>
  #include <morphnormal_vertex>
  #include <skinbase_vertex>
  #include <begin_vertex>
  #include <morphtarget_vertex>
  #include <skinning_vertex>
  #include <project_vertex>
  #include <logdepthbuf_vertex>
  #include <fog_vertex>
  ${TO_WORLD}
  vec3 place = (to_world * vec4(transformed, 1.0)).xyz;
  #ifdef USE_SKINNING
    mat4 blend = skinWeight.x * boneMatX + skinWeight.y * boneMatY + skinWeight.z * boneMatZ + skinWeight.w * boneMatW;
    to_world *= bindMatrixInverse * blend * bindMatrix;
  #endif
  ${writeVaryings(names, 'objectNormal', 'to_world', 'place')}
  #ifdef CLOUD_SHADE
    cloud_light.x *= shadePastOthers(place, cloud_shade_shift);
  #endif
  cloud_view = isOrthographic ? -vec3(viewMatrix[0][2], viewMatrix[1][2], viewMatrix[2][2]) : place - cameraPosition;
}
`;

const TO_SCREEN = `
  #ifdef OWN_TONE
    gl_FragColor.rgb = toneMap(gl_FragColor.rgb, exposure);
  #else
    #include <tonemapping_fragment>
    #include <colorspace_fragment>
  #endif
`;

const CLOUD_FRAGMENT = `
#include <common>
#include <dithering_pars_fragment>
#include <fog_pars_fragment>
#include <logdepthbuf_pars_fragment>
${VARYINGS}
${PIXEL_COLOR}
${TONE}
${CHANNELS}
uniform vec2 painted_range;  // of depth, while PaintedClouds draws
#ifdef SOFT
  ${SOFT}
  ${SOLID_DISTANCE}
  uniform highp sampler2D solid_depth;
  uniform vec3 solid_clip;  // near and far plane, and 1.0 if there is such a texture
#endif

void main() {
  #include <logdepthbuf_fragment>
  float away = -dot(cloud_view, vec3(viewMatrix[0][2], viewMatrix[1][2], viewMatrix[2][2]));
  float opacity = 1.0;
  vec2 light = cloud_light;
  #ifdef SOFT
    light *= insideFactor(cloud_normal, cloud_view);
    float solid = solid_clip.z > 0.0 ? solidDistance(solid_depth, ivec2(gl_FragCoord.xy), solid_clip.xy) : 1e30;
    opacity = opacityOfPixel(cloud_normal, cloud_view, cloud_place, away, solid);
    float threshold = thresholdOfPixel();
    #ifdef ALPHA_TO_COVERAGE
      if (threshold == 1.0) discard;
    #else
      if (opacity <= threshold) discard;
      opacity = 1.0;
    #endif
  #endif
  if (painted_range.y > painted_range.x) {
    gl_FragColor = channelsOf(cloud_light, away, painted_range);
    return;
  }
  gl_FragColor = vec4(colorOfPixel(light, cloud_view), opacity);
  #ifdef LAMPS
    gl_FragColor.rgb += cloud_lamps;
  #endif
  ${TO_SCREEN}
  #include <fog_fragment>
  #include <dithering_fragment>
}
`;

const IMPOSTOR_VERTEX = `
#include <common>
#include <batching_pars_vertex>
#include <fog_pars_vertex>
#include <logdepthbuf_pars_vertex>
${IMPOSTOR_VARYINGS}
${IMPOSTOR_SQUARE}
void main() {
  #include <batching_vertex>
  ${TO_WORLD}
  vec3 axis = vec3(viewMatrix[0][2], viewMatrix[1][2], viewMatrix[2][2]);
  vec3 place = cornerInWorld(position.xy, to_world, cameraPosition, axis, !isOrthographic);
  vec4 mvPosition = viewMatrix * vec4(place, 1.0);
  gl_Position = projectionMatrix * mvPosition;
  #include <logdepthbuf_vertex>
  #include <fog_vertex>
  cloud_view = isOrthographic ? -axis : place - cameraPosition;
}
`;

const IMPOSTOR_FRAGMENT = `
#include <common>
#include <dithering_pars_fragment>
#include <fog_pars_fragment>
#include <logdepthbuf_pars_fragment>
${IMPOSTOR_VARYINGS}
${PIXEL_COLOR}
${TONE}
${IMPOSTOR_PIXEL}
void main() {
  #include <logdepthbuf_fragment>
  vec3 light = impostorLight(to_sun);
  if (!(light.z > 0.0)) discard;
  gl_FragColor = vec4(colorOfPixel(light.xy, cloud_view), light.z);
  ${TO_SCREEN}
  #include <fog_fragment>
  #include <dithering_fragment>
}
`;

const SKY_VERTEX = `
varying vec3 sky_view;

void main() {
  gl_Position = vec4(position.xy, 0.0, 1.0);
  sky_view = transpose(mat3(viewMatrix)) * (inverse(projectionMatrix) * vec4(position.xy, 0.0, 1.0)).xyz;
}
`;

const SKY_FRAGMENT = `
#include <common>
#include <dithering_pars_fragment>
varying vec3 sky_view;
${SKY_COLOR}
${TONE}
void main() {
  gl_FragColor = vec4(colorOfSky(sky_view), 1.0);
  ${TO_SCREEN}
  #include <dithering_fragment>
}
`;

const target = new Vector3(), viewport = new Vector4(), colorOf = rgb => new Color(...rgb);

/** @typedef {import('./three.d.ts').CloudSettings} Settings */

// What clouds and sky have in common: the sun, and the way to the screen's colours.
class SunlitMaterial extends ShaderMaterial {
  /** @type {Settings['sunLight']} */ sunLight;
  /** @type {Settings['sunColor']} */ sunColor;
  /** @type {Settings['exposure']} */ exposure;

  constructor(uniforms, shaders) {
    super({ ...shaders,
      uniforms: { ...UniformsUtils.clone(UniformsLib.fog), ...uniforms, to_sun: { value: new Vector3() }, exposure: { value: 1 } } });
    this.sunDirection = new Vector3(...DAY.sunDirection);
    Object.assign(this, sunDefaults(colorOf));
  }

  get tone() { return 'OWN_TONE' in this.defines ? 'cloudbake' : 'renderer'; }
  set tone(name) {
    if (name === 'cloudbake') this.defines.OWN_TONE = '';
    else delete this.defines.OWN_TONE;
    this.needsUpdate = true;
  }

  // What each material has of its own.
  writeUniforms() {}

  // three.js calls it before each mesh that it draws with the material.
  onBeforeRender() {
    const { uniforms, sunDirection, sunLight, exposure } = this;
    if (sunLight) sunDirection.setFromMatrixPosition(sunLight.matrixWorld).sub(target.setFromMatrixPosition(sunLight.target.matrixWorld));
    uniforms.to_sun.value.copy(sunDirection).normalize();
    uniforms.exposure.value = exposure;
    this.writeUniforms();
    this.uniformsNeedUpdate = true;
  }

  copy(source) {
    super.copy(source);
    this.sunDirection.copy(source.sunDirection);
    this.sunColor.copy(source.sunColor);
    this.sunLight = source.sunLight;
    this.exposure = source.exposure;
    return this;
  }
}

// A PointLight or a SpotLight as a lamp of lamp.glsl.
function lampOf(/** @type {import('three').PointLight | import('three').SpotLight} */ light) {
  const place = new Vector3().setFromMatrixPosition(light.matrixWorld), color = light.color.clone().multiplyScalar(light.intensity);
  const lamp = { place, color, range: light.distance, radius: light.userData.radius ?? 0, axis: new Vector3(), cone: new Vector2(-1, -1) };
  if (!('angle' in light)) return lamp;
  lamp.axis.setFromMatrixPosition(light.target.matrixWorld).sub(place).normalize();
  lamp.cone.set(Math.cos(light.angle * (1 - light.penumbra)), Math.cos(light.angle));
  return lamp;
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
  /** @type {Settings['harmonicExtinction']} */ harmonicExtinction;
  /** @type {Settings['depthTexture']} */ depthTexture;

  constructor(parameters = {}) {
    const colors = { sun_color: { value: new Color() }, ambient_sky: { value: new Color() }, ambient_ground: { value: new Color() } };
    const numbers = { extinction: { value: 0 }, half_lambert: { value: 0 }, volume_gain: { value: 1 }, flipped: { value: 0 },
      density_max: { value: 0 }, own_extinction: { value: 1 }, to_mesh: { value: new Matrix3() } };
    const soft = Object.fromEntries([...Object.keys(softValues({})), 'solid_depth', 'solid_clip'].map(name => [name, { value: null }]));
    super({ ...colors, ...numbers, ...soft, lamps: { value: [] }, shape: { value: new Vector2() }, phase: { value: new Vector3() },
      painted_range: { value: new Vector2() }, cloud_shade_shift: { value: new Vector3() } }, { fragmentShader: CLOUD_FRAGMENT });
    this.type = 'CloudMaterial';
    this.isCloudMaterial = true;
    this.painted = null;  // what PaintedClouds needs while it draws
    this.fog = true;
    Object.assign(this, cloudDefaults(colorOf));
    this.setValues(parameters);
  }

  get uvSets() { return this.sets; }
  set uvSets(sets) {
    this.sets = [...sets];
    this.writeShader();
  }

  get harmonicOrder() { return this.order; }
  set harmonicOrder(order) {
    this.order = order;
    this.writeShader();
  }

  writeShader() {
    if (!this.sets) return;
    this.vertexShader = cloudVertex(this.sets.map(nameOfSet), this.order);
    this.needsUpdate = true;
  }

  get phase() { return this.scattering; }
  set phase(given) { this.scattering = { ...DAY.phase, ...given }; }

  get lamps() { return this.lampList; }
  set lamps(lights) {
    if (lights.length !== (this.defines.LAMPS ?? 0)) this.needsUpdate = true;
    if (lights.length > 0) this.defines.LAMPS = lights.length;
    else delete this.defines.LAMPS;
    this.lampList = lights;
  }

  // The CloudShade that shades the clouds of the material; null: none does.
  get cloudShade() { return this.shade ?? null; }
  set cloudShade(shade) {
    this.shade = shade;
    if (shade) this.defines.CLOUD_SHADE = '';
    else delete this.defines.CLOUD_SHADE;
    this.needsUpdate = true;
    if (shade) Object.assign(this.uniforms, shade.uniforms);
  }

  get soft() { return 'SOFT' in this.defines; }
  set soft(is_soft) {
    if (is_soft === this.soft) return;
    if (is_soft) this.defines.SOFT = '';
    else delete this.defines.SOFT;
    this.needsUpdate = true;
  }

  onBeforeRender(...given) {
    const { to_mesh } = this.uniforms, [, , { near, far }, , mesh] = given;
    if (mesh.userData.cloudToMesh) to_mesh.value.fromArray(mesh.userData.cloudToMesh);
    else to_mesh.value.identity();
    if (mesh.userData.cloudShadeShift) this.uniforms.cloud_shade_shift.value.fromArray(mesh.userData.cloudShadeShift);
    if (this.soft) this.writeSoft(mesh.userData.cloudShown, near, far);
    super.onBeforeRender();
  }

  writeSoft(shown, near, far) {
    const depth = this.painted ? null : this.depthTexture;
    for (const [name, value] of Object.entries(softValues(this, this.painted, shown))) this.uniforms[name].value = value;
    this.uniforms.solid_depth.value = depth;
    this.uniforms.solid_clip.value = [near, far, depth ? 1 : 0];
  }

  writeUniforms() {
    const { uniforms } = this;
    uniforms.sun_color.value.copy(this.sunColor);
    uniforms.ambient_sky.value.copy(this.ambientSky);
    uniforms.ambient_ground.value.copy(this.ambientGround);
    uniforms.shape.value.set(this.exponent, this.bias);
    uniforms.extinction.value = this.extinction;
    uniforms.density_max.value = this.densityMax;
    uniforms.own_extinction.value = this.harmonicExtinction;
    uniforms.half_lambert.value = this.painted?.halfLambert ?? this.halfLambert;
    uniforms.volume_gain.value = this.ofVolume ? this.painted?.volumeGain ?? 1 : 1;
    uniforms.painted_range.value.fromArray(this.painted?.depthRange ?? [0, 0]);
    uniforms.flipped.value = this.flipV ? 1 : 0;
    uniforms.phase.value.set(this.phase.share, this.phase.asymmetry, this.phase.limit);
    if (this.lamps.length > 0) uniforms.lamps.value = this.lamps.map(lampOf);
  }

  copy(source) {
    super.copy(source);
    this.ambientSky.copy(source.ambientSky);
    this.ambientGround.copy(source.ambientGround);
    const own = ['exponent', 'bias', 'extinction', 'densityMax', 'uvSets', 'halfLambert', 'phase', 'flipV', 'ofVolume', 'harmonicOrder',
      'harmonicExtinction', 'rimFrequency', 'rimScroll', 'insideLight', 'ditherShift', 'depthTexture', 'lamps', ...SOFT_NAMES, 'soft',
      'cloudShade'];
    for (const key of own) this[key] = source[key];
    return this;
  }
}

addSoftSettings(CloudMaterial);

// For the square of an impostor (impostorSquare), which turns to the camera by itself: `cloudbake impostor` makes the atlas.
export class ImpostorMaterial extends SunlitMaterial {
  /** @type {Settings['ambientSky']} */ ambientSky;
  /** @type {Settings['ambientGround']} */ ambientGround;
  /** @type {Settings['exponent']} */ exponent;
  /** @type {Settings['extinction']} */ extinction;
  /** @type {Settings['ofVolume']} */ ofVolume;
  /** @type {number} */ volumeGain;
  /** @type {number[]} */ center;
  /** @type {number} */ radius;
  /** @type {number[]} */ atlas;
  /** @type {import('three').Texture | null} */ lobeTexture;
  /** @type {import('three').Texture | null} */ restTexture;

  constructor(parameters = {}) {
    const colors = { sun_color: { value: new Color() }, ambient_sky: { value: new Color() }, ambient_ground: { value: new Color() } };
    const own = Object.fromEntries(['impostor_lobe', 'impostor_rest', 'impostor_atlas', 'impostor_center', 'impostor_radius',
      'impostor_scale', 'impostor_exponent', 'extinction', 'volume_gain'].map(name => [name, { value: null }]));
    super({ ...colors, ...own, phase: { value: new Vector3() } },
      { vertexShader: IMPOSTOR_VERTEX, fragmentShader: IMPOSTOR_FRAGMENT, transparent: true, depthWrite: false, side: DoubleSide });
    this.type = 'ImpostorMaterial';
    this.isImpostorMaterial = true;
    this.fog = true;
    Object.assign(this, impostorDefaults(colorOf));
    this.setValues(parameters);
  }

  get phase() { return this.scattering; }
  set phase(given) { this.scattering = { ...DAY.phase, ...given }; }

  onBeforeRender(...given) {
    const [renderer, , camera] = given, { elements } = camera.projectionMatrix;
    this.uniforms.impostor_scale.value = 2 / (elements[5] * renderer.getCurrentViewport(viewport).w);
    super.onBeforeRender();
  }

  writeUniforms() {
    const { uniforms } = this;
    uniforms.sun_color.value.copy(this.sunColor);
    uniforms.ambient_sky.value.copy(this.ambientSky);
    uniforms.ambient_ground.value.copy(this.ambientGround);
    uniforms.impostor_exponent.value = this.exponent;
    uniforms.extinction.value = this.extinction;
    uniforms.volume_gain.value = this.ofVolume ? this.volumeGain : 1;
    uniforms.phase.value.set(this.phase.share, this.phase.asymmetry, this.phase.limit);
    uniforms.impostor_center.value = this.center;
    uniforms.impostor_radius.value = this.radius;
    uniforms.impostor_atlas.value = this.atlas;
    uniforms.impostor_lobe.value = this.lobeTexture;
    uniforms.impostor_rest.value = this.restTexture;
  }

  copy(source) {
    super.copy(source);
    this.ambientSky.copy(source.ambientSky);
    this.ambientGround.copy(source.ambientGround);
    const own = ['exponent', 'extinction', 'ofVolume', 'volumeGain', 'phase', 'center', 'radius', 'atlas', 'lobeTexture', 'restTexture'];
    for (const key of own) this[key] = source[key];
    return this;
  }
}

// The square of a material's impostor. Its bounds are those of the ball.
export function impostorSquare({ center, radius }) {
  const square = new BufferGeometry().setAttribute('position',
    new BufferAttribute(new Float32Array([-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0]), 3)).setIndex([0, 1, 2, 0, 2, 3]);
  const middle = new Vector3(...center), reach = new Vector3(radius, radius, radius);
  square.boundingSphere = new Sphere(middle, radius);
  square.boundingBox = new Box3(middle.clone().sub(reach), middle.clone().add(reach));
  return square;
}

// Puts the instances of an InstancedMesh of impostors into the order in which they must be drawn: the farthest from the camera first.
export function sortImpostors(mesh, camera) {
  const { count, instanceMatrix: { array }, instanceColor } = mesh, eye = new Vector3().setFromMatrixPosition(camera.matrixWorld);
  const { center } = mesh.geometry.boundingSphere, matrix = new Matrix4(), copy = array.slice(0, 16 * count);
  const colors = instanceColor?.array.slice(0, 3 * count);
  mesh.updateWorldMatrix(true, false);
  const order = Array.from({ length: count }, (_, i) => {
    mesh.getMatrixAt(i, matrix);
    return { i, away: target.copy(center).applyMatrix4(matrix).applyMatrix4(mesh.matrixWorld).distanceToSquared(eye) };
  }).sort((a, b) => b.away - a.away || a.i - b.i);
  if (order.every(({ i }, at) => i === at)) return;
  order.forEach(({ i }, at) => {
    array.set(copy.subarray(16 * i, 16 * i + 16), 16 * at);
    if (colors) instanceColor.array.set(colors.subarray(3 * i, 3 * i + 3), 3 * at);
  });
  mesh.instanceMatrix.needsUpdate = true;
  if (colors) instanceColor.needsUpdate = true;
}

// A texture of an atlas, as its shader reads it.
function asAtlas(texture) {
  return Object.assign(texture, { colorSpace: NoColorSpace, minFilter: LinearMipmapLinearFilter, magFilter: LinearFilter,
    generateMipmaps: true, wrapS: ClampToEdgeWrapping, wrapT: ClampToEdgeWrapping, needsUpdate: true });
}

// For a mesh that covers the screen, such as CloudSky, and cameras with perspective.
export class SkyMaterial extends SunlitMaterial {
  constructor(parameters = {}) {
    const colors = Object.fromEntries([...Object.values(SKY), 'sun_color'].map(name => [name, { value: new Color() }]));
    super(colors, { vertexShader: SKY_VERTEX, fragmentShader: SKY_FRAGMENT, depthTest: false, depthWrite: false });
    this.type = 'SkyMaterial';
    Object.assign(this, skyDefaults(colorOf));
    this.setValues(parameters);
  }

  writeUniforms() {
    const { uniforms } = this;
    for (const [name, uniform] of Object.entries(SKY)) uniforms[uniform].value.copy(this[name]);
    uniforms.sun_color.value.copy(this.sunColor);
  }

  copy(source) {
    super.copy(source);
    for (const name of Object.keys(SKY)) this[name].copy(source[name]);
    return this;
  }
}

// The sky behind everything else of a scene.
export class CloudSky extends Mesh {
  constructor(material = new SkyMaterial()) {
    const triangle = new BufferGeometry().setAttribute('position',
      new BufferAttribute(new Float32Array([-1, -1, 0, 3, -1, 0, -1, 3, 0]), 3));
    super(triangle, material);
    this.frustumCulled = false;
    this.renderOrder = -1e9;
  }
}

// loader.register(parser => new CloudbakeLoaderPlugin(parser)): meshes of baked files are drawn with one CloudMaterial, which is also
// gltf.userData.cloudMaterial; the square of an impostor with an ImpostorMaterial, gltf.userData.impostorMaterial. `parameters`: those of
// the material.
export class CloudbakeLoaderPlugin {
  constructor(parser, parameters = {}) {
    this.name = 'cloudbake';
    this.parser = parser;
    this.parameters = parameters;
  }

  async afterRoot(gltf) {
    const impostor = impostorSettingsOf(this.parser.json);
    if (impostor) return this.makeImpostor(gltf, impostor);
    const settings = settingsOf(this.parser.json, { sequences: true });
    if (!settings) return;
    const names = settings.uvSets.map(nameOfSet), clouds = [], has = ({ geometry }, all) => all.every(name => geometry.hasAttribute(name));
    for (const scene of gltf.scenes) {
      scene.updateMatrixWorld(true);
      scene.traverse(mesh => { if (mesh.isMesh && has(mesh, names)) clouds.push(mesh); });
    }
    // An optimiser may have dropped the harmonics: without them there are the lobes.
    if (!clouds.every(mesh => has(mesh, harmonicNames(settings.harmonicOrder)))) settings.harmonicOrder = 0;
    const material = new CloudMaterial({ ...settings, ...this.parameters });
    for (const mesh of clouds) {
      if (!mesh.geometry.hasAttribute('normal')) mesh.geometry.computeVertexNormals();
      if (mesh.material.side === DoubleSide && !this.parameters.side) material.side = DoubleSide;
      if (settings.harmonicOrder > 0) mesh.userData.cloudToMesh = new Matrix3().setFromMatrix4(mesh.matrixWorld).invert().toArray();
      mesh.material = material;
    }
    gltf.userData.cloudMaterial = material;
    gltf.userData.cloudSwitchPixels = switchPixelsOf(this.parser.json);
  }

  // A picture of its own per texture: one that the loader shares with the file's material may have been made for it.
  async makeImpostor(gltf, { textures, ...settings }) {
    const [lobeTexture, restTexture] = (await Promise.all([textures.lobe, textures.rest].map(number =>
      this.parser.getDependency('texture', number)))).map(texture => asAtlas(texture.clone()));
    const material = new ImpostorMaterial({ ...settings, lobeTexture, restTexture, ...this.parameters }), square = impostorSquare(material);
    for (const scene of gltf.scenes) scene.traverse(mesh => { if (mesh.isMesh) Object.assign(mesh, { geometry: square, material }); });
    gltf.userData.impostorMaterial = material;
  }
}

// The levels of detail of a cloud (`cloudbake bake --lods`), from the results of GLTFLoader, the full asset first. They switch by the size
// on the screen where the renderer draws them, as `cloudbake preview` does.
export class CloudLevels extends LOD {
  constructor(gltfs, { switchBand = 0.3, pictureHeight = 0 } = {}) {
    super();
    this.isCloudLevels = true;
    this.switchBand = switchBand;
    this.pictureHeight = pictureHeight;
    this.switches = gltfs.map(({ userData }) => userData.cloudSwitchPixels);
    gltfs.forEach(({ scene, userData: { cloudMaterial } }, i) => {
      this.addLevel(scene, i);
      cloudMaterial.soft = true;
    });
  }

  // The renderer calls it before it draws.
  update(camera) {
    this.updateWorldMatrix(true, true);
    const [{ object: full }] = this.levels, box = new Box3().setFromObject(full), own = new Box3();
    const longest = Math.max(0, ...meshesOf(full).map(({ geometry, matrixWorld }) => {
      if (!geometry.boundingBox) geometry.computeBoundingBox();
      return stretchedSides(own.copy(geometry.boundingBox).getSize(new Vector3()).toArray(), matrixWorld.elements);
    }));
    const eye = new Vector3().setFromMatrixPosition(camera.matrixWorld).toArray(), tangent = 1 / camera.projectionMatrix.elements[5];
    const height = this.pictureHeight || globalThis.innerHeight * globalThis.devicePixelRatio;
    const shown = shownLevels(pixelsAcross(longest, box.min.toArray(), box.max.toArray(), eye, tangent, height), this.switches,
      this.switchBand);
    this.levels.forEach(({ object }, i) => {
      object.visible = shown[i] !== null;
      for (const mesh of meshesOf(object)) mesh.userData.cloudShown = shown[i] ?? [0, 1];
    });
  }
}

function meshesOf(object) {
  const meshes = [];
  object.traverse(one => { if (one.material?.isCloudMaterial) meshes.push(one); });
  return meshes;
}

// The shadow of a cloud that `cloudbake shadow` wrote: SHADOW.png, and SHADOW.json with its frame.
export class CloudShadow {
  constructor(texture, frame, strength = 1) {
    Object.assign(texture, { minFilter: LinearFilter, generateMipmaps: false, colorSpace: NoColorSpace });
    this.shadowStrength = strength;
    this.frame = frame;
    this.uniforms = { cloud_shadow: { value: texture } };
    this.update();
  }

  static async load(picture, strength = 1) {
    const answer = await fetch(picture.replace(/\.png$/, '.json'));
    if (!answer.ok) throw new Error(`${picture} has no frame beside it: ${answer.url} answers ${answer.status}; copy both files`);
    return new CloudShadow(await new TextureLoader().loadAsync(picture), await answer.json(), strength);
  }

  // After a change of the frame or of the strength.
  update() {
    for (const [name, value] of Object.entries(shadowValues(this.frame, this.shadowStrength))) (this.uniforms[name] ??= {}).value = value;
  }

  // A built-in material with lights gets the shadow: its direct light is darkened.
  darken(material) {
    return darkenLights(material, this.uniforms, { name: 'cloud_shadow', text: CAST_SHADOW, share: 'castShadow' });
  }
}
