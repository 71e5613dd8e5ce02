// The mean of the depth over a square: the sums of each row's pixels first, then of the columns'. Then the least opacity of nine places.
uniform highp sampler2D channels, sums;
uniform int radius, shrink;
uniform bool of_rows, mean_all;
out vec4 value;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  ivec2 last = textureSize(channels, 0) - 1;
  ivec2 axis = of_rows ? ivec2(1, 0) : ivec2(0, 1);
  vec2 total = vec2(0.0);  // depths by weight, weights
  for (int i = -radius; i <= radius; i++) {
    vec4 p = texelFetch(sums, clamp(at + i * axis, ivec2(0), last), 0);
    total += of_rows ? (mean_all ? 1.0 : p.z) * vec2(p.w, 1.0) : p.xy;
  }
  if (of_rows) {
    value = vec4(total, 0.0, 0.0);
    return;
  }
  value = texelFetch(channels, at, 0);
  if (radius > 0 && total.y > 0.0) {
    value.w = total.x / total.y;
  }
  for (int i = 0; i < 9; i++) {
    ivec2 other = clamp(at + shrink * (ivec2(i % 3, i / 3) - 1), ivec2(0), last);
    value.z = min(value.z, texelFetch(channels, other, 0).z);
  }
}
