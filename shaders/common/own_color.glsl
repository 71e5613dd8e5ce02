// The clouds' own colour at a pixel; white where it is not known, because the light may cover more pixels.
uniform highp sampler2D own_red_green, own_blue;  // channels of the picture's size, with colours in place of light
uniform bool has_own;

vec3 ownColor(ivec2 at) {
  if (!has_own) {
    return vec3(1.0);
  }
  vec4 red_green = texelFetch(own_red_green, at, 0), blue = texelFetch(own_blue, at, 0);
  return vec3(red_green.z > 0.0 ? red_green.xy : vec2(1.0), blue.z > 0.0 ? blue.x : 1.0);
}
