// The largest number of surfaces in a block of 8 x 8 pixels.
uniform highp sampler2D counts;
out vec4 value;

void main() {
  ivec2 from = 8 * ivec2(gl_FragCoord.xy);
  ivec2 end = min(from + 8, textureSize(counts, 0));
  float most = 0.0;
  for (int y = from.y; y < end.y; y++) {
    for (int x = from.x; x < end.x; x++) {
      most = max(most, texelFetch(counts, ivec2(x, y), 0).g);
    }
  }
  value = vec4(0.0, most, 0.0, 0.0);
}
