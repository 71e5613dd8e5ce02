// Clouds that shade each other and the ground, in three.js: a grid of the optical depth of the sky along the sun's light.
import { Box3, Data3DTexture, DataTexture, DataUtils, HalfFloatType, InstancedBufferAttribute, LinearFilter, Matrix4, RedFormat,
  Vector4 } from 'three';
import { casterOf } from './caster.js';
import { ShadeGrid, shadeFrame } from './shade_grid.js';
import { SweptShadow } from './swept_shadow.js';
import { darkenLights } from './three_darken.js';

const READ_SHADE = `
uniform highp sampler2D cloud_ground;
uniform vec4 cloud_shade_rows[3];
uniform float cloud_shade_strength;

// The share of the sun's light that comes to a place below all clouds.
float shadeOfClouds(vec3 place) {
  vec4 world = vec4(place, 1.0);
  vec2 at = vec2(dot(cloud_shade_rows[0], world), dot(cloud_shade_rows[1], world));
  vec2 size = vec2(textureSize(cloud_ground, 0));
  return 1.0 - cloud_shade_strength * (1.0 - texture(cloud_ground, (at + 0.5) / size).r);
}
`;

/** A texture of half floats between 0 and 1 that is read between its places. @param {number[]} size @param {ArrayLike<number>} numbers */
function textureOf([width, height, depth], numbers) {
  const halves = Uint16Array.from(numbers, DataUtils.toHalfFloat);
  const texture = depth ? new Data3DTexture(halves, width, height, depth) : new DataTexture(halves, width, height);
  Object.assign(texture, { format: RedFormat, type: HalfFloatType, minFilter: LinearFilter, magFilter: LinearFilter, unpackAlignment: 1,
    needsUpdate: true });
  return texture;
}

// The matrices of the copies of a mesh in the world.
function placesOf(mesh) {
  if (!mesh.isInstancedMesh) return [mesh.matrixWorld];
  return Array.from({ length: mesh.count }, (_, i) => {
    const place = new Matrix4();
    mesh.getMatrixAt(i, place);
    return place.premultiply(mesh.matrixWorld);
  });
}

export class CloudShade {
  constructor({ strength = 1 } = {}) {
    this.shadeStrength = strength;
    this.meshes = [];
    this.casters = new Map();  // by geometry
    this.shadows = new Map();  // by geometry, σ and how it is turned, under one sun
    this.grid = null;
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
      this.meshes.push(mesh);
      mesh.material.cloudShade = this;
    });
    return this;
  }

  remove(object) {
    object.traverse(mesh => {
      if (!this.meshes.includes(mesh)) return;
      this.meshes = this.meshes.filter(one => one !== mesh);
      if (!this.meshes.some(({ material }) => material === mesh.material)) mesh.material.cloudShade = null;
    });
    return this;
  }

  casterOf({ geometry }) {
    if (!this.casters.has(geometry)) {
      const { position } = geometry.attributes, positions = new Float32Array(3 * position.count);
      for (let i = 0; i < position.count; ++i) positions.set([position.getX(i), position.getY(i), position.getZ(i)], 3 * i);
      const triangles = geometry.index?.array ?? Uint32Array.from({ length: position.count }, (_, i) => i);
      this.casters.set(geometry, casterOf(positions, triangles));
    }
    return this.casters.get(geometry);
  }

  shadowOf(mesh, place, light) {
    const { elements: m } = place, linear = [0, 1, 2, 4, 5, 6, 8, 9, 10].map(i => m[i]), { extinction } = mesh.material;
    const key = `${mesh.geometry.id} ${extinction} ${linear.map(Math.fround)}`;
    if (!this.shadows.has(key)) {
      const back = new Matrix4().set(m[0], m[4], m[8], 0, m[1], m[5], m[9], 0, m[2], m[6], m[10], 0, 0, 0, 0, 1).invert().elements;
      const to_own = [0, 1, 2, 4, 5, 6, 8, 9, 10].map(i => back[i]).concat(0, 0, 0), settings = { strength: 1, softness: 0 };
      this.shadows.set(key, new SweptShadow(this.casterOf(mesh), to_own, extinction, light, settings));
    }
    return this.shadows.get(key);
  }

  // Makes the textures anew. Call it after clouds or sun have moved; `sun`: the direction to it, as of the materials.
  update(sun) {
    const length = Math.hypot(sun.x, sun.y, sun.z), light = [sun.x / length, sun.y / length, sun.z / length], key = String(light);
    if (key !== this.lightKey) this.shadows.clear();
    this.lightKey = key;
    const clouds = [], box = new Box3(), whole = new Box3();
    let sides = 0;
    for (const mesh of this.meshes) {
      mesh.updateWorldMatrix(true, false);
      if (!mesh.geometry.boundingBox) mesh.geometry.computeBoundingBox();
      for (const place of placesOf(mesh)) {
        const { elements: m } = place;
        clouds.push({ shadow: this.shadowOf(mesh, place, light), at: [m[12], m[13], m[14]], scale: 1, cosine: 1, sine: 0, power: 1 });
        box.copy(mesh.geometry.boundingBox).applyMatrix4(place);
        const side = Math.max(box.max.x - box.min.x, box.max.y - box.min.y, box.max.z - box.min.z);
        sides += side;
        whole.union(box.expandByScalar(side / 8));
      }
    }
    if (!clouds.length) return;
    const extent = { low: whole.min.toArray(), high: whole.max.toArray(), cloud_size: sides / clouds.length };
    this.grid = new ShadeGrid(shadeFrame(extent, light, [0, 0, 0]), clouds, light);
    this.writeTextures(clouds.length);
  }

  writeTextures(count) {
    const { grid, uniforms } = this, { nodes: [width, height, depth], rows } = grid.frame;
    const { size, numbers, shifts } = grid.packed(Array.from({ length: count }, (_, own) => ({ ...grid.columns[own], own })));
    for (const { value } of [uniforms.cloud_shades, uniforms.cloud_ground]) value.dispose();
    uniforms.cloud_shades.value = textureOf(size, numbers);
    uniforms.cloud_ground.value = textureOf([width, height], grid.sharesAround({ first: [0, 0, depth - 1], count: [width, height, 1] }));
    uniforms.cloud_shade_strength.value = this.shadeStrength;
    rows.forEach((row, i) => uniforms.cloud_shade_rows.value[i].fromArray(row));
    let first = 0;
    for (const mesh of this.meshes) {
      const copies = mesh.isInstancedMesh ? mesh.count : 1, own = shifts.slice(3 * first, 3 * (first + copies));
      if (mesh.isInstancedMesh) mesh.geometry.setAttribute('cloud_shade_shift', new InstancedBufferAttribute(own, 3));
      else mesh.userData.cloudShadeShift = own;
      first += copies;
    }
  }

  // A built-in material with lights gets the shade of all clouds: its direct light is darkened. For things below the clouds.
  darken(material) {
    return darkenLights(material, this.uniforms, { name: 'cloud_shade', text: READ_SHADE, share: 'shadeOfClouds' });
  }

  dispose() {
    for (const name of ['cloud_shades', 'cloud_ground']) this.uniforms[name].value.dispose();
  }
}
