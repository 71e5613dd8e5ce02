// The sums so far and one more sample of each pixel. b counts the samples that meet a cloud.
uniform highp sampler2D sums, samples;
out vec4 value;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  value = texelFetch(sums, at, 0) + texelFetch(samples, at, 0);
}
