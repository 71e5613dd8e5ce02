// Clouds that cloudbake has baked, in three.js (WebGLRenderer).
import { BufferAttribute, BufferGeometry, Color, DoubleSide, Matrix3, Mesh, ShaderMaterial, UniformsLib, UniformsUtils,
  Vector2, Vector3 } from 'three';
import { DAY, SKY, cloudDefaults, settingsOf, skyDefaults, sunDefaults } from './asset.js';
import { CHANNELS, PIXEL_COLOR, SKY_COLOR, TONE, harmonicNames, vertexLight } from './shaders.js';

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
varying vec2 cloud_light;
varying vec3 cloud_view;
${vertexLight(order)}
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
  mat4 to_world = modelMatrix;
  #ifdef USE_INSTANCING
    to_world *= instanceMatrix;
  #endif
  #ifdef USE_BATCHING
    to_world *= batchingMatrix;
  #endif
  vec3 place = (to_world * vec4(transformed, 1.0)).xyz;
  #ifdef USE_SKINNING
    mat4 blend = skinWeight.x * boneMatX + skinWeight.y * boneMatY + skinWeight.z * boneMatZ + skinWeight.w * boneMatW;
    to_world *= bindMatrixInverse * blend * bindMatrix;
  #endif
  cloud_light = lightOfVertex(${names.join(', ')}, objectNormal, mat3(to_world));
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
varying vec2 cloud_light;
varying vec3 cloud_view;
${PIXEL_COLOR}
${TONE}
${CHANNELS}
uniform vec2 painted_range;  // of depth, while PaintedClouds draws

void main() {
  #include <logdepthbuf_fragment>
  if (painted_range.y > painted_range.x) {
    gl_FragColor = channelsOf(cloud_light, -dot(cloud_view, vec3(viewMatrix[0][2], viewMatrix[1][2], viewMatrix[2][2])), painted_range);
    return;
  }
  gl_FragColor = vec4(colorOfPixel(cloud_light, cloud_view), 1.0);
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

const target = new Vector3(), colorOf = rgb => new Color(...rgb);

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

export class CloudMaterial extends SunlitMaterial {
  /** @type {Settings['ambientSky']} */ ambientSky;
  /** @type {Settings['ambientGround']} */ ambientGround;
  /** @type {Settings['exponent']} */ exponent;
  /** @type {Settings['bias']} */ bias;
  /** @type {Settings['extinction']} */ extinction;
  /** @type {Settings['halfLambert']} */ halfLambert;
  /** @type {Settings['flipV']} */ flipV;
  /** @type {Settings['ofVolume']} */ ofVolume;
  /** @type {Settings['harmonicExtinction']} */ harmonicExtinction;

  constructor(parameters = {}) {
    const colors = { sun_color: { value: new Color() }, ambient_sky: { value: new Color() }, ambient_ground: { value: new Color() } };
    const numbers = { extinction: { value: 0 }, half_lambert: { value: 0 }, volume_gain: { value: 1 }, flipped: { value: 0 },
      own_extinction: { value: 1 }, to_mesh: { value: new Matrix3() } };
    super({ ...colors, ...numbers, shape: { value: new Vector2() }, phase: { value: new Vector3() },
      painted_range: { value: new Vector2() } }, { fragmentShader: CLOUD_FRAGMENT });
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

  onBeforeRender(...given) {
    const { to_mesh } = this.uniforms, [, , , , mesh] = given;
    if (mesh.userData.cloudToMesh) to_mesh.value.fromArray(mesh.userData.cloudToMesh);
    else to_mesh.value.identity();
    super.onBeforeRender();
  }

  writeUniforms() {
    const { uniforms } = this;
    uniforms.sun_color.value.copy(this.sunColor);
    uniforms.ambient_sky.value.copy(this.ambientSky);
    uniforms.ambient_ground.value.copy(this.ambientGround);
    uniforms.shape.value.set(this.exponent, this.bias);
    uniforms.extinction.value = this.extinction;
    uniforms.own_extinction.value = this.harmonicExtinction;
    uniforms.half_lambert.value = this.painted?.halfLambert ?? this.halfLambert;
    uniforms.volume_gain.value = this.ofVolume ? this.painted?.volumeGain ?? 1 : 1;
    uniforms.painted_range.value.fromArray(this.painted?.depthRange ?? [0, 0]);
    uniforms.flipped.value = this.flipV ? 1 : 0;
    uniforms.phase.value.set(this.phase.share, this.phase.asymmetry, this.phase.limit);
  }

  copy(source) {
    super.copy(source);
    this.ambientSky.copy(source.ambientSky);
    this.ambientGround.copy(source.ambientGround);
    const own = ['exponent', 'bias', 'extinction', 'uvSets', 'halfLambert', 'phase', 'flipV', 'ofVolume', 'harmonicOrder',
      'harmonicExtinction'];
    for (const key of own) this[key] = source[key];
    return this;
  }
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
// gltf.userData.cloudMaterial. `parameters`: those of the material.
export class CloudbakeLoaderPlugin {
  constructor(parser, parameters = {}) {
    this.name = 'cloudbake';
    this.parser = parser;
    this.parameters = parameters;
  }

  async afterRoot(gltf) {
    const settings = settingsOf(this.parser.json);
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
  }
}
