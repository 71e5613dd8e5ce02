// Clouds of the summed density, in parts before, between and behind surfaces.
uniform DensityClouds marched;

vec3 shadowAt(vec3 point) {
  return sky_share + (1.0 - sky_share) * meshShare(point * marched.scale);
}

void main() {
  DensityClouds clouds = marched;
  if (fewer > 1.0) {
    clouds.octaves = min(clouds.octaves, 3);
    clouds.parts = min(clouds.parts, 4);
    clouds.part_length *= 2.0;
  }
  Cuts cuts = cutsAt(ivec2(gl_FragCoord.xy), samples_per_side);
  vec3 view = viewDirection(samplePlace(samples_per_side));
  float jitter = clouds.dither * jitterAt(clouds.seed);
  vec3 sky = theSkyColor(view);
  writeParts(marchDensityCloud(eye / clouds.scale, view, to_light, sky, jitter, scaledCuts(cuts, clouds.scale), clouds), cuts, clouds.scale);
}
