// Clouds that shade each other and the ground, in three.js: a grid of the optical depth of the sky along the sun's light.
import { Data3DTexture, DataTexture, DataUtils, HalfFloatType, InstancedBufferAttribute, LinearFilter, Matrix4, RedFormat,
  Vector4 } from 'three';
import { MeshShade } from './mesh_shade.js';
import { GROUND_SHADE } from './shaders.js';
import { darkenLights } from './three_darken.js';

/** A texture of half floats between 0 and 1 that is read between its places. @param {number[]} size @param {ArrayLike<number>} numbers */
function textureOf([width, height, depth], numbers) {
  const halves = Uint16Array.from(numbers, DataUtils.toHalfFloat);
  const texture = depth ? new Data3DTexture(halves, width, height, depth) : new DataTexture(halves, width, height);
  Object.assign(texture, { format: RedFormat, type: HalfFloatType, minFilter: LinearFilter, magFilter: LinearFilter, unpackAlignment: 1,
    needsUpdate: true });
  return texture;
}

export class CloudShade extends MeshShade {
  constructor({ strength = 1 } = {}) {
    super(strength);
    this.uniforms = { cloud_ground: { value: textureOf([1, 1], [1]) }, cloud_shade_strength: { value: strength },
      cloud_shade_rows: { value: [new Vector4(), new Vector4(), new Vector4()] }, cloud_shades: { value: textureOf([1, 1, 1], [1]) } };
  }

  // The clouds of an object: all its meshes with a CloudMaterial.
  add(object) {
    object.traverse(mesh => {
      if (!mesh.material?.isCloudMaterial || this.meshes.includes(mesh)) return;
      if (mesh.isBatchedMesh) throw new Error('CloudShade takes Mesh and InstancedMesh; a BatchedMesh has no attribute per copy');
      if (mesh.isInstancedMesh && this.meshes.some(({ geometry }) => geometry === mesh.geometry))
        throw new Error('CloudShade: an InstancedMesh needs a geometry of its own; clone it');
      this.take(mesh);
    });
    return this;
  }

  remove(object) {
    object.traverse(mesh => this.leave(mesh));
    return this;
  }

  placesOf(mesh) {
    mesh.updateWorldMatrix(true, false);
    if (!mesh.isInstancedMesh) return [mesh.matrixWorld.elements];
    return Array.from({ length: mesh.count }, (_, i) => {
      const place = new Matrix4();
      mesh.getMatrixAt(i, place);
      return place.premultiply(mesh.matrixWorld).elements;
    });
  }

  shapeOf({ geometry: { attributes: { position }, index } }) {
    const positions = new Float32Array(3 * position.count);
    for (let i = 0; i < position.count; ++i) positions.set([position.getX(i), position.getY(i), position.getZ(i)], 3 * i);
    return { positions, triangles: index?.array ?? Uint32Array.from({ length: position.count }, (_, i) => i) };
  }

  showShares(past_others, on_ground) {
    const { uniforms } = this;
    for (const { value } of [uniforms.cloud_shades, uniforms.cloud_ground]) value.dispose();
    uniforms.cloud_shades.value = textureOf(past_others.size, past_others.numbers);
    uniforms.cloud_ground.value = textureOf(on_ground.size, on_ground.numbers);
    uniforms.cloud_shade_strength.value = this.shadeStrength;
    this.grid.frame.rows.forEach((row, i) => uniforms.cloud_shade_rows.value[i].fromArray(row));
  }

  setShifts(mesh, shifts) {
    if (mesh.isInstancedMesh) mesh.geometry.setAttribute('cloud_shade_shift', new InstancedBufferAttribute(shifts, 3));
    else mesh.userData.cloudShadeShift = shifts;
  }

  // A built-in material with lights gets the shade of all clouds: its direct light is darkened. For things below the clouds.
  darken(material) {
    return darkenLights(material, this.uniforms, { name: 'cloud_shade', text: GROUND_SHADE, share: 'shadeOfClouds' });
  }

  dispose() {
    for (const name of ['cloud_shades', 'cloud_ground']) this.uniforms[name].value.dispose();
  }
}
