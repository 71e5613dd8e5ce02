// The image at another size: each pixel is a bilinear mean of four about its centre.
uniform highp sampler2D channels;
uniform vec2 size;
out vec4 value;

void main() {
  ChannelSum sum = ChannelSum(vec4(0.0), vec2(0.0));
  addBilinear(channels, gl_FragCoord.xy * (vec2(textureSize(channels, 0)) / size), 1.0, sum);
  value = channelMean(sum);
}
