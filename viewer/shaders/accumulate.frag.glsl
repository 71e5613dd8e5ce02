// The sums so far and one more sample of each pixel, which counts `share`.
uniform highp sampler2D sums, samples;
uniform float share;
out vec4 value;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  value = texelFetch(sums, at, 0) + share * texelFetch(samples, at, 0);
}
