// The whole sky: skyColor of preview/backdrop/sky.h.
uniform bool has_smooth_disc, has_moon, has_stars;
uniform SmoothDisc smooth_disc;
uniform Moon moon;
uniform Stars stars;
uniform vec4 craters[CRATERS];

vec3 theSkyColor(vec3 view) {
  vec3 color = skyColor(view, theSky());
  bool is_above = view.y + horizonDip(viewer_height) >= 0.0;
  if (has_smooth_disc && is_above) {
    color += smoothDiscColor(view, to_sun, sun_color, smooth_disc);
  } else if (has_smooth_disc) {
    color += smoothDiscColor(atHorizon(view, viewer_height), to_sun, sun_color, smooth_disc) * horizonLine(view.y, horizon_exponent, viewer_height);
  }
  if (is_above && has_stars) {
    float covered = has_moon ? discMask(view, moon.direction, moon.disc_exponent, moon.disc_gain) : 0.0;
    color += starLight(view, to_sun.y, stars) * (1.0 - covered);
  }
  if (is_above && has_moon) {
    color += moonColor(view, moon, craters);
  }
  return color;
}
