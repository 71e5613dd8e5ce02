// Means over places of channels: ChannelSum of preview/mesh_clouds/channels.h.
uniform bool mean_all;  // every place counts; else sun, sky and depth are means over what is covered

struct ChannelSum {
  vec4 counted;  // sun, sky, depth, and what counted
  vec2 covered;  // opacity, and all weights
};

void addChannels(vec4 channels, float weight, inout ChannelSum sum) {
  float counted = mean_all ? weight : weight * channels.z;
  sum.counted += counted * vec4(channels.xy, channels.w, 1.0);
  sum.covered += weight * vec2(channels.z, 1.0);
}

vec4 channelMean(ChannelSum sum) {
  if (!(sum.counted.w > 0.0)) {
    return vec4(0.0, 0.0, 0.0, 1.0);
  }
  return vec4(sum.counted.xy / sum.counted.w, sum.covered.x / sum.covered.y, sum.counted.z / sum.counted.w);
}

// The lower left and the upper right of the four pixels about a place, from the corner where the image begins, and the latter's weight.
void findCorners(ivec2 size, vec2 place, out ivec2 low, out ivec2 high, out vec2 part) {
  vec2 corner = clamp(place - 0.5, vec2(0.0), vec2(size - 1));
  low = ivec2(corner);
  high = min(low + 1, size - 1);
  part = corner - vec2(low);
}

void addBilinear(highp sampler2D image, vec2 place, float weight, inout ChannelSum sum) {
  ivec2 low, high;
  vec2 part;
  findCorners(textureSize(image, 0), place, low, high, part);
  addChannels(texelFetch(image, low, 0), weight * (1.0 - part.x) * (1.0 - part.y), sum);
  addChannels(texelFetch(image, ivec2(high.x, low.y), 0), weight * part.x * (1.0 - part.y), sum);
  addChannels(texelFetch(image, ivec2(low.x, high.y), 0), weight * (1.0 - part.x) * part.y, sum);
  addChannels(texelFetch(image, high, 0), weight * part.x * part.y, sum);
}
