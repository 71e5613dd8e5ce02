// The mean of several samples: everywhere, or where a pixel differs from a neighbour by more than a 256th.
uniform highp sampler2D centers;
uniform vec2 places[16];
uniform int count;
uniform bool everywhere;
out vec4 value;

bool differs(ivec2 at, vec3 color) {
  ivec2 size = textureSize(centers, 0);
  vec3 change = abs(texelFetch(centers, clamp(at, ivec2(0), size - 1), 0).rgb - color);
  return max(change.r, max(change.g, change.b)) > 1.0 / 256.0;
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  value = texelFetch(centers, at, 0);
  if (everywhere || differs(at - ivec2(1, 0), value.rgb) || differs(at + ivec2(1, 0), value.rgb) ||
      differs(at - ivec2(0, 1), value.rgb) || differs(at + ivec2(0, 1), value.rgb)) {
    vec3 sum = vec3(0.0);
    for (int i = 0; i < count; i++) {
      sum += theSkyColor(viewDirection(vec2(at) + vec2(places[i].x, 1.0 - places[i].y)));
    }
    value = vec4(sum / float(count), 1.0);
  }
}
