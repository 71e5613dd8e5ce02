// The whole sky: skyColor of preview/backdrop/sky.h.
uniform bool has_smooth_disc, has_moon, has_smooth_moon, has_moon_picture, has_stars, has_aurora;
uniform SmoothDisc smooth_disc;
uniform Moon moon;
uniform Stars stars;
uniform Aurora aurora;
uniform vec4 craters[CRATERS];
uniform highp sampler2D moon_picture;  // linear; its first row is the top

vec3 moonPicture(vec2 uv) {
  ivec2 size = textureSize(moon_picture, 0);
  vec2 at = clamp(vec2(uv.y, 1.0 - uv.x) * vec2(size) - 0.5, vec2(0.0), vec2(size - 1));
  ivec2 low = ivec2(at);
  ivec2 high = min(low + 1, size - 1);
  vec2 part = at - vec2(low);
  vec3 above = mix(texelFetch(moon_picture, low, 0).rgb, texelFetch(moon_picture, ivec2(high.x, low.y), 0).rgb, part.x);
  vec3 below = mix(texelFetch(moon_picture, ivec2(low.x, high.y), 0).rgb, texelFetch(moon_picture, high, 0).rgb, part.x);
  return mix(above, below, part.y);
}

vec3 theSkyColor(vec3 view) {
  Night night = Night(has_smooth_disc, has_moon, has_smooth_moon, has_moon_picture, has_stars, has_aurora, smooth_disc, moon, stars,
                      aurora);
  return nightSkyColor(view, theSky(), night, craters);
}
