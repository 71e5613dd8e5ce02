// Reads the keys of a sequence from their picture. Needs sequence.glsl, and before it
//   vec3 sequenceKey(vec2 at), a function: the values of a texel of the picture, 0 to 1, without any conversion. 'at' are its column and
//     its row, from the first row of the PNG on
// and the uniforms
//   vec3 sequence_low, sequence_high: the box; float sequence_densest: density_max of the sequence
//   vec3 sequence_place: of the segment its first row, the rows that its vertices need, and how many keys it has
//   vec2 sequence_moment: the last key that is not after the moment, and how far the moment is on its way to the next one, 0 to 1

// The bytes of a vertex in a block of a key.
vec3 keyBytes(vec2 own, float block, float key) {
  vec2 at = sequenceTexel(own, sequence_place, block, key);
  return sequenceBytes(sequenceKey(at));
}

// The vertex at the moment: returns its position, and gives its normal and its lobe. 'own': TEXCOORD_2 of the vertex.
vec3 sequenceVertex(vec2 own, out vec3 normal, out vec4 lobe) {
  float earlier = sequence_moment.x;
  float later = min(earlier + 1.0, sequence_place.z - 1.0);
  vec3 from = sequencePosition(keyBytes(own, 0.0, earlier), keyBytes(own, 1.0, earlier), sequence_low, sequence_high);
  vec3 to = sequencePosition(keyBytes(own, 0.0, later), keyBytes(own, 1.0, later), sequence_low, sequence_high);
  vec3 from_third = keyBytes(own, 2.0, earlier);
  vec3 from_fourth = keyBytes(own, 3.0, earlier);
  vec3 to_third = keyBytes(own, 2.0, later);
  vec3 to_fourth = keyBytes(own, 3.0, later);
  normal = blendedNormal(sequenceDirection(from_fourth.xy), sequenceDirection(to_fourth.xy), sequence_moment.y);
  vec4 first = sequenceLobe(from_third, from_fourth, sequence_densest);
  lobe = blendedLobe(first, sequenceLobe(to_third, to_fourth, sequence_densest), sequence_moment.y);
  return mix(from, to, sequence_moment.y);
}
