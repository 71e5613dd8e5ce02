// Clouds of the distance-like field, in parts before, between and behind surfaces.
uniform DistanceClouds marched;

vec3 shadowAt(vec3 point) {
  return sky_share + (1.0 - sky_share) * meshShare(point * marched.scale);
}

void main() {
  DistanceClouds clouds = marched;
  if (fewer > 1.0) {
    clouds.octaves = min(clouds.octaves, 3);
  }
  Cuts cuts = cutsAt(ivec2(gl_FragCoord.xy), samples_per_side);
  vec3 view = viewDirection(samplePlace(samples_per_side));
  float jitter = clouds.dither * jitterAt(clouds.seed);
  writeParts(marchDistanceCloud(eye / clouds.scale, view, to_light, jitter, scaledCuts(cuts, clouds.scale), clouds), cuts, clouds.scale);
}
