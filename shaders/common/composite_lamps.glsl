// The light of lamps on the clouds at a pixel, before the fog: after composite.glsl.
uniform highp sampler2D lamps_red_green, lamps_blue;  // channels with the light of lamps in place of that of sun and sky
uniform bool has_lamps;

vec3 lampsAt(ivec2 at) {
  return has_lamps ? vec3(channelsAt(lamps_red_green, at).xy, channelsAt(lamps_blue, at).x) : vec3(0.0);
}
