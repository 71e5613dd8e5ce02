// One direction of a Gaussian of 7 taps, whose width follows the depth of the resulting pixel.
uniform highp sampler2D channels;
uniform ivec2 axis;
uniform float near_sigma, far_sigma;
uniform bool as_quoted;
out vec4 value;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  ivec2 last = textureSize(channels, 0) - 1;
  value = texelFetch(channels, at, 0);
  float sigma = mix(near_sigma, far_sigma, min(value.w, 1.0));
  float factor = (as_quoted ? -2.0 : -0.5) / (sigma * sigma);
  vec4 weights = vec4(1.0, exp(factor), exp(4.0 * factor), exp(9.0 * factor));
  float total = 1.0 + 2.0 * (weights.y + weights.z + weights.w);
  if (weights.y < 5.9604644775390625e-8) {
    return;
  }
  ChannelSum sum = ChannelSum(vec4(0.0), vec2(0.0));
  for (int tap = -3; tap <= 3; tap++) {
    float weight = weights[abs(tap)];
    addChannels(texelFetch(channels, clamp(at + tap * axis, ivec2(0), last), 0),
                weight < 5.9604644775390625e-8 ? 0.0 : weight / total, sum);
  }
  value = vec4(channelMean(sum).xyz, value.w);
}
