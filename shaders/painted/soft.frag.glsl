// Light and opacity after the boxes.
uniform highp sampler2D channels, weighted;
out vec4 value;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec4 mean = texelFetch(weighted, at, 0);
  float depth = texelFetch(channels, at, 0).w;
  value = vec4(0.0, 0.0, 0.0, depth);
  if (mean.z > 1e-4) {
    value = vec4(mean.xy / mean.z, min(mean.z, 1.0), depth);
  }
}
