uniform vec3 to_sun, zenith, low_sky, horizon, ground, sun_color, ambient_sky, ambient_ground, disc;
uniform float horizon_exponent, viewer_height, horizon_strength;
uniform vec3 horizon_color;

Sky theSky() {
  vec4 line = vec4(horizon_color, horizon_strength);
  return Sky(to_sun, zenith, low_sky, horizon, ground, sun_color, disc, horizon_exponent, viewer_height, line);
}
