// The nearest surface behind the one that was drawn before: light of sun and sky, distance, and the sense of the crossing.
in vec4 shade;
in vec3 from_eye, own_color;
uniform highp sampler2D nearer;  // depths
uniform float divider;
uniform bool has_own;
layout(location = 0) out vec4 surface;
layout(location = 1) out vec4 own;  // the cloud's own colour

void main() {
  if (gl_FragCoord.z <= texelFetch(nearer, ivec2(gl_FragCoord.xy), 0).r) {
    discard;
  }
  vec2 light = max(gl_FragCoord.x < divider ? shade.xy : shade.zw, 0.0);
  surface = vec4(light, length(from_eye), gl_FrontFacing ? 1.0 : -1.0);
  own = vec4(has_own ? own_color : vec3(1.0), 1.0);
}
