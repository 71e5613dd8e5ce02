// Light along the view through one more surface, front to back: the formula is in preview/mesh_clouds/render.cpp. The cloud fills the view
// where the winding number is not 0. A pixel without another surface keeps what it has, in the one or the other of two targets.
in vec4 shade;
in vec3 from_eye;
uniform highp sampler2D signs, colors, entries;
uniform bool is_first;
uniform float divider;
uniform vec3 sun_color, ambient_sky, ambient_ground;
uniform float view_extinction;  // per world unit, along the view
layout(location = 0) out vec4 color;  // light so far, and the share of what is behind that comes through
layout(location = 1) out vec4 entry;  // where the view came into the cloud: light of sun and sky, distance; the winding number

vec3 colorOf(vec2 light) {
  return cloudColor(light.x, light.y, sun_color, ambient_sky, ambient_ground);
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec2 light = clamp(gl_FragCoord.x < divider ? shade.xy : shade.zw, 0.0, 1.0);
  color = is_first ? vec4(0.0, 0.0, 0.0, 1.0) : texelFetch(colors, at, 0);
  entry = is_first ? vec4(0.0) : texelFetch(entries, at, 0);
  if (color.a == 0.0) {
    return;
  }
  if (is_first && texelFetch(signs, at, 0).r != 0.0) {  // open: the first surface is opaque
    color = vec4(colorOf(light), 0.0);
    return;
  }
  float distance = length(from_eye);
  if (entry.w == 0.0) {
    entry.xyz = vec3(light, distance);
  }
  entry.w += gl_FrontFacing ? 1.0 : -1.0;
  if (entry.w != 0.0) {
    return;
  }
  float depth = view_extinction * (distance - entry.z);
  float passed = exp(-depth);
  float later = depth > 1e-3 ? (1.0 - passed) / depth - passed : 0.5 * depth;
  vec3 near = colorOf(entry.xy);
  color.rgb += color.a * (near * (1.0 - passed) + (colorOf(light) - near) * later);
  color.a *= passed;
}
