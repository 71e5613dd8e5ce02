// The mean over the samples so far: sun, sky and depth over what is covered, and the share that is covered.
uniform highp sampler2D sums;
uniform float share;  // of all samples
out vec4 value;

void main() {
  vec4 sum = texelFetch(sums, ivec2(gl_FragCoord.xy), 0);
  value = vec4(0.0, 0.0, 0.0, 1.0);
  if (sum.z > 0.0) {
    value = vec4(sum.xy / sum.z, sum.z / share, sum.w / sum.z);
  }
}
