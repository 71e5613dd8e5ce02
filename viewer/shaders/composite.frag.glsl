// The clouds over the sky, in the 8 bits of the screen.
uniform highp sampler2D channels, drawn, background;  // 'drawn': the channels before the steps of the chain
uniform float fog_density, exposure;
uniform float distance_fog;  // per world unit; over 0 it replaces the fog by depth
uniform vec3 fog_color;
uniform vec2 depth_range;
uniform vec3 phase;  // share, asymmetry, limit
out vec4 value;

// The channels may be smaller than the picture.
vec4 channelsAt(highp sampler2D image, ivec2 at) {
  vec2 size = vec2(textureSize(image, 0));
  if (size == picture) {
    return texelFetch(image, at, 0);
  }
  ChannelSum sum = ChannelSum(vec4(0.0), vec2(0.0));
  addBilinear(image, (vec2(at) + 0.5) * (size / picture), 1.0, sum);
  return channelMean(sum);
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec4 p = channelsAt(channels, at);
  vec3 color = texelFetch(background, at, 0).rgb;
  if (p.z > 0.0) {
    vec3 view = viewDirection(gl_FragCoord.xy);
    float factor = phaseFactor(view, to_sun, phase.x, phase.y, phase.z);
    vec3 cloud = cloudColor(p.x, p.y, sun_color * factor, ambient_sky, ambient_ground);
    float fog = fog_density * p.w;
    if (distance_fog > 0.0) {
      vec4 own = channelsAt(drawn, at);
      fog = distance_fog * mix(depth_range.x, depth_range.y, own.z > 0.0 ? own.w : p.w) / dot(view, forward);
    }
    color = mix(color, mix(cloud, fog_color, 1.0 - exp(-fog)), p.z);
  }
  ivec2 from_top = ivec2(at.x, int(picture.y) - 1 - at.y);
  value = vec4(toneMap(color, exposure) + ditherOffset(from_top), 1.0);
}
