// Sequences (`cloudbake sequence --as picture`): what the texels of the picture of the keys mean, and what is between two keys. The same as
// core/sequence.h and io/gltf/sequence/key_texture.h. Textures are read by whoever calls this; sequence_keys.glsl does it.
// Needs lobe.glsl.

// The column and the row of a texel. 'own': TEXCOORD_2 of the vertex; 'place': the first row of the segment, the rows that its vertices
// need, and how many keys it has; 'block': 0.0 to 3.0; 'key': from 0.0 on.
vec2 sequenceTexel(vec2 own, vec3 place, float block, float key) {
  return vec2(own.x, place.x + (block * place.y + own.y) * place.z + key);
}

// The bytes of a texel, from its values between 0 and 1.
vec3 sequenceBytes(vec3 texel) {
  return floor(texel * 255.0 + 0.5);
}

// The position of a vertex from the bytes of the blocks 0 and 1, and from the two corners of the box.
vec3 sequencePosition(vec3 high, vec3 low, vec3 low_corner, vec3 high_corner) {
  return low_corner + (high_corner - low_corner) * ((256.0 * high + low) / 65535.0);
}

// A direction from its two bytes: the normal is in block 3.
vec3 sequenceDirection(vec2 bytes) {
  vec2 place = bytes / 127.5 - 1.0;
  return octahedralDirection(place);
}

// The lobe from the bytes of the blocks 2 and 3. 'densest': density_max of the sequence.
vec4 sequenceLobe(vec3 third, vec3 fourth, float densest) {
  float root = (256.0 * third.z + fourth.z) / 65535.0;
  return vec4(sequenceDirection(third.xy), densest * root * root);
}

// The normal between two keys, a unit vector. 'share': how far the moment is on its way from the first key to the second one, 0 to 1.
vec3 blendedNormal(vec3 from, vec3 to, float share) {
  vec3 mixed = mix(from, to, share);
  float size = length(mixed);
  if (!(size > 0.0)) {
    return from;
  }
  return mixed / size;
}

// The lobe between two keys: o is a unit vector again, and d is multiplied by the length that o had.
vec4 blendedLobe(vec4 from, vec4 to, float share) {
  vec4 mixed = mix(from, to, share);
  float size = length(mixed.xyz);
  if (!(size > 0.0)) {
    return vec4(mixed.xyz, 0.0);
  }
  return vec4(mixed.xyz / size, mixed.w * size);
}
