// The mean of the samples of each pixel: sun, sky and depth over what is covered, and the share that is covered. A sample has sun, sky,
// depth, and 1.0 where there is a cloud.
uniform highp sampler2D samples;
uniform int samples_per_side;  // the picture of the samples is so many times as wide and high
out vec4 value;

void main() {
  ivec2 first = ivec2(gl_FragCoord.xy) * samples_per_side;
  ChannelSum sum = ChannelSum(vec4(0.0), vec2(0.0));
  for (int i = 0; i < samples_per_side * samples_per_side; i++) {
    vec4 p = texelFetch(samples, first + ivec2(i % samples_per_side, i / samples_per_side), 0);
    addChannels(vec4(p.xy, step(0.5, p.w), p.z), 1.0, sum);  // an engine may have filtered them, so that covering is not quite 0 or 1
  }
  value = channelMean(sum);
}
