// The sky behind clouds, without a moon: the same as preview/backdrop/sky.h. Vectors have length 1, colours are linear.

struct Sky {
  vec3 to_sun;
  vec3 zenith;
  vec3 low_sky;          // where the gradient begins, above the line at the horizon
  vec3 horizon;
  vec3 ground;
  vec3 sun_color;
  vec3 disc;             // exponent, gain, and the strength of the glow around the sun
  float horizon_exponent;  // how thin the line at the horizon is
  float viewer_height;   // in radii of the planet
  vec4 line;             // colour of the line, and how much of it the line has
};

// Sine of the angle by which the horizon is below level.
float horizonDip(float viewer_height) {
  float cosine = 1.0 / (1.0 + viewer_height);
  return sqrt(max(0.0, 1.0 - cosine * cosine));
}

float horizonLine(float view_y, float exponent, float viewer_height) {
  return pow(clamp(1.0 - abs(view_y + horizonDip(viewer_height)), 0.0, 1.0), exponent);
}

// 1 on the disc of the sun, then a soft rim.
float discMask(vec3 view, vec3 towards, float exponent, float gain) {
  float cosine = max(0.0, dot(towards, view));
  if (exponent * (1.0 - cosine) > 200.0) {
    return 0.0;
  }
  return min(1.0, pow(cosine, exponent) * gain);
}

// The wide glow around the sun.
vec3 sunGlow(vec3 view, Sky sky) {
  float cosine = max(0.0, dot(view, sky.to_sun));
  float squared = cosine * cosine;
  float fourth = squared * squared;
  return sky.sun_color * (sky.disc.z * fourth * fourth * fourth * fourth * fourth * fourth);
}

// The horizon above or below a view.
vec3 atHorizon(vec3 view, float viewer_height) {
  float dip = horizonDip(viewer_height);
  float across = length(view.xz);
  if (!(across > 0.0)) {
    return view;
  }
  float scale = sqrt(max(0.0, 1.0 - dip * dip)) / across;
  return vec3(view.x * scale, -dip, view.z * scale);
}

vec3 skyColor(vec3 view, Sky sky) {
  float dip = horizonDip(sky.viewer_height);
  float height = view.y + dip;
  float line = horizonLine(view.y, sky.horizon_exponent, sky.viewer_height);
  vec3 line_color = mix(sky.horizon, sky.line.rgb, sky.line.a);
  if (height < 0.0) {
    return mix(sky.ground, line_color + sunGlow(atHorizon(view, sky.viewer_height), sky), line);
  }
  vec3 color = mix(mix(sky.low_sky, sky.zenith, sqrt(min(1.0, height))), line_color, line);
  color += sunGlow(view, sky);
  return color + sky.sun_color * (4.0 * discMask(view, sky.to_sun, sky.disc.x, sky.disc.y));
}
