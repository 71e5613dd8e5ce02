// A vertex's own colour in place of its light: red and green, or blue.
vec4 ownChannels(vec3 own, int shown) {
  return vec4(shown == 3 ? own.xy : vec2(own.z, 0.0), 0.0, 0.0);
}
