// What is seen of painted clouds among solid things. Needs soft.glsl, channel_sum.glsl and composite.glsl.
uniform float soft_distance;  // a cloud fades over this distance before something solid; world units, 0.0: a hard edge
uniform vec2 far_fade;        // the distances where clouds begin to fade and where they are gone; 0.0 and 0.0: nowhere

// The channels of a texel, as far as it is before 'solid', a distance along the view's axis.
void addVisible(ivec2 texel, float weight, float solid, inout ChannelSum sum) {
  vec4 p = texelFetch(channels, texel, 0);
  vec4 own = texelFetch(drawn, texel, 0);
  float far = mix(depth_range.x, depth_range.y, own.z > 0.0 ? own.w : p.w);
  p.z *= fadeBetween(solid - far, 0.0, soft_distance) * fadeBetween(far, far_fade.y, far_fade.x);
  addChannels(p, weight, sum);
}

// The channels of a pixel that shows something solid at that distance. Where the channels are smaller than the picture, the solid thing
// hides each of the four texels about the pixel by itself. A mean of their depths would hide or show a near and a far cloud together.
vec4 visibleChannels(ivec2 at, float solid) {
  ivec2 size = textureSize(channels, 0);
  ivec2 low = at;
  ivec2 high = at;
  vec2 part = vec2(0.0);
  if (!all(equal(vec2(size), picture))) {
    findCorners(size, (vec2(at) + 0.5) * (vec2(size) / picture), low, high, part);
  }
  ChannelSum sum = ChannelSum(vec4(0.0), vec2(0.0));
  addVisible(low, (1.0 - part.x) * (1.0 - part.y), solid, sum);
  if (!all(equal(low, high))) {
    addVisible(ivec2(high.x, low.y), part.x * (1.0 - part.y), solid, sum);
    addVisible(ivec2(low.x, high.y), (1.0 - part.x) * part.y, solid, sum);
    addVisible(high, part.x * part.y, solid, sum);
  }
  return channelMean(sum);
}
