// Depth carried beyond the clouds.
uniform highp sampler2D channels, weighted;
out vec4 value;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec4 mean = texelFetch(weighted, at, 0);
  value = texelFetch(channels, at, 0);
  value.w = 1.0;
  if (mean.z > 1e-4) {
    value.w = mean.x / mean.z;
  }
}
