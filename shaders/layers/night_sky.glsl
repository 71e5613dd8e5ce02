// The whole sky: skyColor of preview/backdrop/sky.h.
uniform bool has_smooth_disc, has_moon, has_smooth_moon, has_stars;
uniform SmoothDisc smooth_disc;
uniform Moon moon;
uniform Stars stars;
uniform vec4 craters[CRATERS];

vec3 theSkyColor(vec3 view) {
  return nightSkyColor(view, theSky(), Night(has_smooth_disc, has_moon, has_smooth_moon, has_stars, smooth_disc, moon, stars), craters);
}
