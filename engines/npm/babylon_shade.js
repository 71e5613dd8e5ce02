// Clouds that shade each other and the ground, in Babylon.js: a grid of the optical depth of the sky along the sun's light.
import '@babylonjs/core/Engines/Extensions/engine.rawTexture.js';
import { VertexBuffer } from '@babylonjs/core/Buffers/buffer.js';
import { Constants } from '@babylonjs/core/Engines/constants.js';
import { RawTexture } from '@babylonjs/core/Materials/Textures/rawTexture.js';
import { RawTexture3D } from '@babylonjs/core/Materials/Textures/rawTexture3D.js';
import { Matrix, Vector3 } from '@babylonjs/core/Maths/math.vector.js';
import { ToHalfFloat } from '@babylonjs/core/Misc/textureTools.js';
import { CloudMaterial } from './babylon.js';
import { darkenLights } from './babylon_darken.js';
import { MeshShade } from './mesh_shade.js';
import { GROUND_SHADE } from './shaders.js';

const SHIFT = 'cloud_shade_shift';

/** A texture of half floats between 0 and 1 that is read between its places. @param {number[]} size @param {ArrayLike<number>} numbers */
function textureOf([width, height, depth], numbers, scene) {
  const halves = Uint16Array.from(numbers, ToHalfFloat), { TEXTUREFORMAT_R, TEXTURE_BILINEAR_SAMPLINGMODE } = Constants;
  const how = /** @type {const} */ ([TEXTUREFORMAT_R, scene, false, false, TEXTURE_BILINEAR_SAMPLINGMODE,
    Constants.TEXTURETYPE_HALF_FLOAT]);
  const texture = depth ? new RawTexture3D(halves, width, height, depth, ...how) : new RawTexture(halves, width, height, ...how);
  texture.wrapU = texture.wrapV = texture.wrapR = Constants.TEXTURE_CLAMP_ADDRESSMODE;
  texture.anisotropicFilteringLevel = 1;  // which needs levels of the texture to be right
  return texture;
}

// The meshes of a node and of all below it that are no instances, but those of which they are.
const meshesOf = node => new Set([node, ...node.getChildMeshes(false)].map(mesh => mesh.isAnInstance ? mesh.sourceMesh : mesh));

// What is drawn of a mesh without thin instances: itself and its instances. It may be hidden to be only their original.
const drawnOf = mesh => mesh.instances.length && !(mesh.isVisible && mesh.isEnabled()) ? mesh.instances : [mesh, ...mesh.instances];

export class CloudShade extends MeshShade {
  constructor(scene, { strength = 1 } = {}) {
    super(strength);
    this.scene = scene;
    this.ownShifts = new WeakMap();
    this.rows = new Array(12).fill(0);
    this.textures = { others: textureOf([1, 1, 1], [1], scene), ground: textureOf([1, 1], [1], scene) };
  }

  // The clouds of a node: all its meshes with a CloudMaterial, with their instances.
  add(node) {
    for (const mesh of meshesOf(node)) if (mesh.material instanceof CloudMaterial) this.take(mesh);
    return this;
  }

  remove(node) {
    for (const mesh of meshesOf(node)) this.leave(mesh);
    return this;
  }

  placesOf(mesh) {
    const world = mesh.computeWorldMatrix(true);
    if (!mesh.hasThinInstances) return drawnOf(mesh).map(one => one.computeWorldMatrix(true).asArray());
    const { matrixData } = mesh._thinInstanceDataStorage;  // thinInstanceGetWorldMatrices keeps what thinInstanceBufferUpdated has replaced
    return Array.from({ length: mesh.thinInstanceCount }, (_, i) => Matrix.FromArray(matrixData, 16 * i).multiply(world).asArray());
  }

  shapeOf(mesh) {
    const positions = mesh.getVerticesData(VertexBuffer.PositionKind), indices = mesh.getIndices();
    return { positions, triangles: indices?.length ? indices : Uint32Array.from({ length: positions.length / 3 }, (_, i) => i) };
  }

  showShares(past_others, on_ground) {
    this.dispose();
    this.rows = this.grid.frame.rows.flat();
    this.textures = { others: textureOf(past_others.size, past_others.numbers, this.scene),
      ground: textureOf(on_ground.size, on_ground.numbers, this.scene) };
  }

  setShifts(mesh, shifts) {
    if (mesh.hasThinInstances) return void mesh.thinInstanceSetBuffer(SHIFT, shifts, 3);
    const drawn = drawnOf(mesh), has_buffer = mesh.instancedBuffers && SHIFT in mesh.instancedBuffers;
    drawn.forEach((one, i) => this.ownShifts.set(one, Vector3.FromArray(shifts, 3 * i)));
    if (!mesh.instances.length) return;
    if (!has_buffer) mesh.registerInstancedBuffer(SHIFT, 3);
    mesh.instancedBuffers[SHIFT] = Vector3.Zero();
    for (const one of drawn) one.instancedBuffers[SHIFT] = this.ownShifts.get(one);
  }

  // CloudMaterial calls it before each mesh. Instances have their shifts as an attribute, but mirrored ones are drawn one by one.
  bind(effect, mesh) {
    effect.setTexture('cloud_shades', this.textures.others);
    effect.setArray4('cloud_shade_rows', this.rows);
    effect.setVector3(SHIFT, this.ownShifts.get(mesh) ?? Vector3.ZeroReadOnly);
  }

  // A StandardMaterial or a PBRMaterial gets the shade of all clouds: its direct light is darkened. For things below the clouds.
  darken(material) {
    return darkenLights(material, { name: 'cloud_shade', text: GROUND_SHADE, share: 'shadeOfClouds(vPositionW)',
      uniforms: ['cloud_shade_rows', 'cloud_shade_strength'], texture: 'cloud_ground', bind: effect => {
        effect.setArray4('cloud_shade_rows', this.rows);
        effect.setFloat('cloud_shade_strength', this.shadeStrength);
        effect.setTexture('cloud_ground', this.textures.ground);
      } });
  }

  dispose() {
    for (const texture of Object.values(this.textures)) texture.dispose();
  }
}
