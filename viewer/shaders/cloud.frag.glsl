// The channels at a sample: sun, sky, 1 where there is a cloud, depth.
in vec3 field;
uniform vec2 depth_range;
out vec4 channels;

void main() {
  channels = vec4(field.xy, 1.0, clamp((field.z - depth_range.x) / (depth_range.y - depth_range.x), 0.0, 1.0));
}
