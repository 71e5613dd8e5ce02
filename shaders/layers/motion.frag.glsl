// Blur along the way that the points of the picture have gone since the shutter opened: preview/grade.h.
uniform highp sampler2D composed, developed;
uniform vec2 scale;  // from tangents to the screen's [-1, 1]
uniform vec3 was_eye, was_right, was_up, was_forward;
uniform int motion_taps;
uniform float motion_limit;
out vec4 value;

vec3 bilinear(vec2 place) {
  vec2 at = clamp(place - 0.5, vec2(0.0), picture - 1.0);
  ivec2 low = ivec2(at);
  ivec2 high = min(low + 1, ivec2(picture) - 1);
  vec3 below = mix(texelFetch(developed, low, 0).rgb, texelFetch(developed, ivec2(high.x, low.y), 0).rgb, at.x - float(low.x));
  vec3 above = mix(texelFetch(developed, ivec2(low.x, high.y), 0).rgb, texelFetch(developed, high, 0).rgb, at.x - float(low.x));
  return mix(below, above, at.y - float(low.y));
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  float distance = texelFetch(composed, at, 0).a;
  vec3 view = viewDirection(gl_FragCoord.xy);
  vec3 offset = distance < 1e29 ? eye - was_eye + view * distance : view;
  float depth = dot(offset, was_forward);
  vec2 now = vec2(dot(view, right), dot(view, up)) / dot(view, forward);
  vec2 moved = vec2(0.0);
  if (depth > 0.0) {
    moved = 0.5 * scale * (now - vec2(dot(offset, was_right), dot(offset, was_up)) / depth);
  }
  value = texelFetch(developed, at, 0);
  if (moved != vec2(0.0) && motion_taps > 1) {
    vec2 way = clamp(moved, vec2(-motion_limit), vec2(motion_limit)) * picture;
    vec3 sum = vec3(0.0);
    for (int i = 0; i < motion_taps; i++) {
      sum += bilinear(gl_FragCoord.xy - way * (float(i) / float(motion_taps - 1)));
    }
    value = vec4(sum / float(motion_taps), 1.0);
  }
}
