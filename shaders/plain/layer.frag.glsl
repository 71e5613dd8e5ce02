// Light along the view through one more surface, front to back: the formula is in preview/mesh_clouds/render.cpp. The cloud fills the view
// where the winding number is not 0.
uniform highp sampler2D surface, own, signs, colors, entries, entry_owns;
uniform bool is_first, first_surface;  // the first surface of all gives the light of the whole view
uniform vec3 sun_color, ambient_sky, ambient_ground;
uniform float view_extinction;  // per world unit, along the view
layout(location = 0) out vec4 color;  // light so far, and the share of what is behind that comes through
layout(location = 1) out vec4 entry;  // where the view came into the cloud: light of sun and sky, distance; the winding number
layout(location = 2) out vec4 entry_own;  // the cloud's own colour there

vec3 colorOf(vec2 light, vec3 own_color) {
  return cloudColor(light.x, light.y, sun_color, ambient_sky, ambient_ground) * own_color;
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec4 here = texelFetch(surface, at, 0);
  color = is_first ? vec4(0.0, 0.0, 0.0, 1.0) : texelFetch(colors, at, 0);
  entry = is_first ? vec4(0.0) : texelFetch(entries, at, 0);
  entry_own = is_first ? vec4(0.0) : texelFetch(entry_owns, at, 0);
  if (here.w == 0.0 || color.a == 0.0) {
    return;
  }
  vec3 here_own = texelFetch(own, at, 0).rgb;
  if (is_first && texelFetch(signs, at, 0).r != 0.0) {  // open: the first surface is opaque
    color = vec4(colorOf(here.xy, here_own), 0.0);
    return;
  }
  if (entry.w == 0.0) {
    bool takes_light = is_first || !first_surface;
    entry.xyz = vec3(takes_light ? here.xy : entry.xy, here.z);
    entry_own.rgb = takes_light ? here_own : entry_own.rgb;
  }
  entry.w += here.w;
  if (entry.w != 0.0) {
    return;
  }
  float depth = view_extinction * (here.z - entry.z);
  float passed = exp(-depth);
  float later = depth > 1e-3 ? (1.0 - passed) / depth - passed : 0.5 * depth;
  vec3 near = colorOf(entry.xy, entry_own.rgb);
  vec3 far = first_surface ? near : colorOf(here.xy, here_own);
  color.rgb += color.a * (near * (1.0 - passed) + (far - near) * later);
  color.a *= passed;
}
