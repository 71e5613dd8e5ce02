// The channels of a surface at a distance along the view's axis: sun, sky, 1 where there is a cloud, depth.
vec4 channelsOf(vec2 light, float along_axis, vec2 depth_range) {
  float depth = (along_axis - depth_range.x) / (depth_range.y - depth_range.x);
  return vec4(clamp(light, 0.0, 1.0), 1.0, max(depth, 0.0));
}
