// Each pixel is the mean of two phases, moved by a flow without divergence. Places count from the top left corner.
uniform highp sampler2D channels;
uniform float tile_size, far_tiles, swirl_strength, far_strength;  // lengths in heights of the picture
uniform vec3 phases;    // the first, the second, and the weight of the second
uniform vec4 drift;     // of the near and the far noise to the right and up, in tiles of their own
uniform uint seed;
uniform int octaves, cells;  // of the noise; its cells per tile
uniform float gain, typical_slope;
uniform float dark;     // factor of the light where two noises are least
out vec4 value;

vec2 flowOf(vec2 tiles, uint own_seed) {
  vec2 slope = fbmGradientSlope(tiles * float(cells), octaves, gain, own_seed, cells);
  return vec2(slope.y, -slope.x) / typical_slope;
}

// A place that counts from the top.
void addFromTop(vec2 place, float weight, inout ChannelSum sum) {
  addBilinear(channels, vec2(place.x, float(textureSize(channels, 0).y) - place.y), weight, sum);
}

void main() {
  ivec2 size = textureSize(channels, 0);
  vec2 place = vec2(gl_FragCoord.x, float(size.y) - gl_FragCoord.y);
  float height = float(size.y);
  float depth = min(texelFetch(channels, ivec2(gl_FragCoord.xy), 0).w, 1.0);
  vec2 tiles = place / (height * tile_size);
  vec2 near = tiles + vec2(-drift.x, drift.y), far = tiles * far_tiles + vec2(-drift.z, drift.w);
  vec2 flow = mix(flowOf(near, seed), flowOf(far, seed + 1u), depth);
  vec2 moved = flow * (height * swirl_strength * mix(1.0, far_strength, depth));
  ChannelSum sum = ChannelSum(vec4(0.0), vec2(0.0));
  addFromTop(place - phases.x * moved, 1.0 - phases.z, sum);
  addFromTop(place - phases.y * moved, phases.z, sum);
  value = channelMean(sum);
  if (dark < 1.0) {
    float near_value = valueNoise3(vec3(near * float(cells), 0.0), mixBits(seed + 2u), cells);
    value.xy *= mix(dark, 1.0, near_value * valueNoise3(vec3(far * float(cells), 0.0), mixBits(seed + 3u), cells));
  }
}
