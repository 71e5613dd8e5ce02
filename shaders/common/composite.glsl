// The clouds over what is behind them.
uniform highp sampler2D channels, drawn;  // 'drawn': the channels before the steps of the chain
uniform float fog_density;
uniform float distance_fog;  // per world unit; over 0 it replaces the fog by depth
uniform vec3 fog_color;
uniform vec2 fog_scatter;  // strength and exponent of the light that fog scatters around the sun
uniform vec2 depth_range;
uniform vec3 phase;  // share, asymmetry, limit

// The channels may be smaller than the picture.
vec4 channelsAt(highp sampler2D image, ivec2 at) {
  vec2 size = vec2(textureSize(image, 0));
  if (all(equal(size, picture))) {
    return texelFetch(image, at, 0);
  }
  ChannelSum sum = ChannelSum(vec4(0.0), vec2(0.0));
  addBilinear(image, (vec2(at) + 0.5) * (size / picture), 1.0, sum);
  return channelMean(sum);
}

// Along the view's axis, to the cloud that was drawn at the pixel.
float distanceOf(vec4 p, ivec2 at) {
  vec4 own = channelsAt(drawn, at);
  return mix(depth_range.x, depth_range.y, own.z > 0.0 ? own.w : p.w);
}

vec3 fogColor(vec3 view) {
  return fog_color + scatteredLight(view, to_sun, sun_color, fog_scatter);
}

// Without fog.
vec3 litCloud(vec4 p, vec3 view) {
  float factor = phaseFactor(view, to_sun, phase.x, phase.y, phase.z);
  return cloudColor(p.x, p.y, sun_color * factor, ambient_sky, ambient_ground);
}

// What of the light of a cloud comes through the fog before it.
float throughFog(vec4 p, vec3 view, ivec2 at) {
  return exp(-(distance_fog > 0.0 ? distance_fog * distanceOf(p, at) / dot(view, forward) : fog_density * p.w));
}

// The colour of a cloud behind that fog.
vec3 inFog(vec3 color, vec4 p, vec3 view, ivec2 at) {
  return mix(color, fogColor(view), 1.0 - throughFog(p, view, at));
}

// A colour behind the clouds of a pixel, whose channels are p.
vec3 behindClouds(vec3 color, vec4 p, ivec2 at) {
  if (!(p.z > 0.0)) {
    return color;
  }
  vec3 view = viewDirection(vec2(at) + 0.5);
  return mix(color, inFog(litCloud(p, view), p, view, at), p.z);
}
