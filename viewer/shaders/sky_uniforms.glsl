uniform vec3 to_sun, zenith, horizon, ground, sun_color, ambient_sky, ambient_ground, disc;
uniform float horizon_exponent, viewer_height;

Sky theSky() {
  return Sky(to_sun, zenith, horizon, ground, sun_color, disc, horizon_exponent, viewer_height);
}
