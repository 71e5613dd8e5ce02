// What the boxes average: depth by opacity (of_depth), or light by opacity.
uniform highp sampler2D channels;
uniform bool of_depth;
out vec4 value;

void main() {
  vec4 p = texelFetch(channels, ivec2(gl_FragCoord.xy), 0);
  if (of_depth) {
    value = vec4(p.z * p.w, 0.0, p.z, 0.0);
  } else {
    value = vec4(p.xy * p.z, p.z, 0.0);
  }
}
