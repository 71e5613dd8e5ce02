// The shadows of mesh clouds: CloudShadow of preview/mesh_clouds/cloud_shadow.h, with sums that viewer/shadows.js has made. A shadow is a
// layer of 'shadow_sums' and a row of 'shadow_frames': 0 to 2, the rows of the way to the cloud's cells, turned so that the light's axis is
// x; 3, the slopes, the spread, and 1 if the light is above; 4, low, high; 5, left, bottom, width, height.
uniform highp sampler2DArray shadow_sums;
uniform highp sampler2D shadow_frames;
uniform int shadow_count;
// The grid of all clouds that shade each other by it: ShadeGrid of preview/mesh_clouds/shade_grid.h.
uniform highp sampler3D shade_shares;
uniform vec4 shade_x, shade_y, shade_z;  // rows that take a point of the world to the coordinates of its nodes
uniform bool has_shade;

float shadowIntegral(int index, vec2 place, vec4 frame) {
  vec2 at = clamp(place - frame.xy + 0.5, vec2(0.0), frame.zw);
  ivec2 cell = min(ivec2(at), ivec2(frame.zw) - 1);
  vec2 part = at - vec2(cell);
  float s00 = texelFetch(shadow_sums, ivec3(cell, index), 0).r;
  float s10 = texelFetch(shadow_sums, ivec3(cell.x + 1, cell.y, index), 0).r;
  float s01 = texelFetch(shadow_sums, ivec3(cell.x, cell.y + 1, index), 0).r;
  float s11 = texelFetch(shadow_sums, ivec3(cell + 1, index), 0).r;
  return mix(mix(s00, s10, part.x), mix(s01, s11, part.x), part.y);
}

float shadowShare(int index, vec3 point) {
  vec4 light = texelFetch(shadow_frames, ivec2(3, index), 0);
  vec4 heights = texelFetch(shadow_frames, ivec2(4, index), 0);
  vec4 frame = texelFetch(shadow_frames, ivec2(5, index), 0);
  vec4 world = vec4(point, 1.0);
  float a = dot(texelFetch(shadow_frames, ivec2(0, index), 0), world);
  float before = light.w > 0.0 ? heights.y - a : a - heights.x;
  float share = clamp(before / (heights.y - heights.x), 0.0, 1.0);
  if (!(share > 0.0)) {
    return 1.0;
  }
  vec4 across = texelFetch(shadow_frames, ivec2(1, index), 0), aside = texelFetch(shadow_frames, ivec2(2, index), 0);
  vec2 place = vec2(dot(across, world), dot(aside, world)) - light.xy * a;
  float middle = 0.5 * (light.w > 0.0 ? max(a, heights.x) + heights.y : min(a, heights.y) + heights.x);
  float radius = max(0.5, light.z * abs(middle - a));
  if (any(lessThan(place + radius, frame.xy - 1.0)) || any(greaterThan(place - radius, frame.xy + frame.zw + 1.0))) {
    return 1.0;
  }
  float sum = shadowIntegral(index, place + radius, frame) - shadowIntegral(index, place + vec2(-radius, radius), frame) -
              shadowIntegral(index, place + vec2(radius, -radius), frame) + shadowIntegral(index, place - radius, frame);
  float passed = clamp(1.0 - sum / (4.0 * radius * radius), 0.0, 1.0);
  return share < 1.0 ? pow(passed, share) : passed;
}

float meshShare(vec3 point) {
  float share = 1.0;
  if (has_shade) {
    vec4 world = vec4(point, 1.0);
    vec3 at = vec3(dot(shade_x, world), dot(shade_y, world), dot(shade_z, world));
    share = texture(shade_shares, (at + 0.5) / vec3(textureSize(shade_shares, 0))).r;
  }
  for (int i = 0; i < shadow_count; i++) {
    share *= shadowShare(i, point);
  }
  return share;
}
