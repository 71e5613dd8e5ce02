// The clouds over the sky, in the 8 bits of the screen.
uniform highp sampler2D channels, background;
uniform float fog_density, exposure;
uniform vec3 phase;  // share, asymmetry, limit
out vec4 value;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec4 p = texelFetch(channels, at, 0);
  vec3 color = texelFetch(background, at, 0).rgb;
  if (p.z > 0.0) {
    float factor = phaseFactor(viewDirection(gl_FragCoord.xy), to_sun, phase.x, phase.y, phase.z);
    vec3 cloud = cloudColor(p.x, p.y, sun_color * factor, ambient_sky, ambient_ground);
    color = mix(color, mix(cloud, horizon, 1.0 - exp(-fog_density * p.w)), p.z);
  }
  ivec2 from_top = ivec2(at.x, int(picture.y) - 1 - at.y);
  value = vec4(toneMap(color, exposure) + ditherOffset(from_top), 1.0);
}
