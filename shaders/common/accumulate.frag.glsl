// The sums so far and one more sample of each pixel, which counts 'share'.
uniform highp sampler2D sums, samples;
uniform float share;
uniform int fineness;  // so many pixels to a side the samples have for each pixel of the sums
uniform ivec2 pixel;   // which of them is taken
out vec4 value;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  value = texelFetch(sums, at, 0) + share * texelFetch(samples, fineness * at + pixel, 0);
}
