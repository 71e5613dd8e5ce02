// Clouds of the summed density for marched.frag and pass_marched.frag.
uniform DensityClouds marched;

// In units of the method; a draft has fewer octaves and longer steps.
SampleSum marchClouds(vec3 origin, vec3 direction, vec3 to_light, vec3 sky, float jitter, Cuts cuts, bool is_draft) {
  DensityClouds clouds = marched;
  if (is_draft) {
    clouds.octaves = min(clouds.octaves, 3);
    clouds.parts = min(clouds.parts, 4);
    clouds.part_length *= 2.0;
  }
  return marchDensityCloud(origin, direction, to_light, sky, jitter, cuts, clouds);
}
