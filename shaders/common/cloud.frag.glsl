// The channels at a sample.
in vec4 shade;
in vec3 from_eye;
uniform vec2 depth_range;
uniform vec3 forward;
uniform float divider, most;  // of the light: 1.0, but more of lamps
out vec4 channels;

void main() {
  vec2 light = gl_FragCoord.x < divider ? shade.xy : shade.zw;
  channels = channelsOf(light, dot(from_eye, forward), depth_range);
  channels.xy = clamp(light, 0.0, most);
}
