// The channels at a sample.
in vec4 shade;
in vec3 from_eye;
uniform vec2 depth_range;
uniform vec3 forward;
uniform float divider, most;
out vec4 channels;

void main() {
  channels = channelsUpTo(most, gl_FragCoord.x < divider ? shade.xy : shade.zw, dot(from_eye, forward), depth_range);
}
