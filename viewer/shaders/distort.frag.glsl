// Each pixel is the mean of two phases, moved by a flow without divergence. Places count from the top left corner.
uniform highp sampler2D channels;
uniform float tile_size, far_tiles, swirl_strength, far_strength;  // lengths in heights of the picture
uniform vec3 phases;    // the first, the second, and the weight of the second
uniform uint seed;
uniform int octaves, cells;  // of the noise; its cells per tile
uniform float gain, typical_slope;
out vec4 value;

// Sums over places: light and depth weighted by opacity, opacity.
void addBilinear(vec2 place, float weight, inout vec4 counted, inout float opacity) {
  ivec2 size = textureSize(channels, 0);
  vec2 corner = clamp(place - 0.5, vec2(0.0), vec2(size - 1));
  ivec2 low = ivec2(corner);
  ivec2 high = min(low + 1, size - 1);
  vec2 part = corner - vec2(low);
  for (int i = 0; i < 4; i++) {
    ivec2 at = ivec2((i & 1) == 0 ? low.x : high.x, i < 2 ? low.y : high.y);
    float share = weight * ((i & 1) == 0 ? 1.0 - part.x : part.x) * (i < 2 ? 1.0 - part.y : part.y);
    vec4 p = texelFetch(channels, ivec2(at.x, size.y - 1 - at.y), 0);
    counted += share * p.z * vec4(p.xy, p.w, 1.0);
    opacity += share * p.z;
  }
}

vec2 flowOf(vec2 tiles, uint own_seed) {
  vec2 slope = fbmGradientSlope(tiles * float(cells), octaves, gain, own_seed, cells);
  return vec2(slope.y, -slope.x) / typical_slope;
}

void main() {
  ivec2 size = textureSize(channels, 0);
  vec2 place = vec2(gl_FragCoord.x, float(size.y) - gl_FragCoord.y);
  float height = float(size.y);
  float depth = texelFetch(channels, ivec2(gl_FragCoord.xy), 0).w;
  vec2 tiles = place / (height * tile_size);
  vec2 flow = mix(flowOf(tiles, seed), flowOf(tiles * far_tiles, seed + 1u), depth);
  vec2 moved = flow * (height * swirl_strength * mix(1.0, far_strength, depth));
  vec4 counted = vec4(0.0);
  float opacity = 0.0;
  addBilinear(place - phases.x * moved, 1.0 - phases.z, counted, opacity);
  addBilinear(place - phases.y * moved, phases.z, counted, opacity);
  value = vec4(0.0, 0.0, 0.0, 1.0);
  if (counted.w > 0.0) {
    value = vec4(counted.xy / counted.w, opacity, counted.z / counted.w);
  }
}
