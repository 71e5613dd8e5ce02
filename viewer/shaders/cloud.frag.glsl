// The channels at a sample: sun, sky, 1 where there is a cloud, depth.
in vec4 shade;
in vec3 from_eye;
uniform vec2 depth_range;
uniform vec3 forward;
uniform float divider;
out vec4 channels;

void main() {
  float depth = (dot(from_eye, forward) - depth_range.x) / (depth_range.y - depth_range.x);
  vec2 light = gl_FragCoord.x < divider ? shade.xy : shade.zw;
  channels = vec4(clamp(light, 0.0, 1.0), 1.0, max(depth, 0.0));
}
