// Clouds of the distance-like field for marched.frag and pass_marched.frag.
uniform DistanceClouds marched;

// In units of the method; a draft has fewer octaves. They have no colour of the sky.
SampleSum marchClouds(vec3 origin, vec3 direction, vec3 to_light, vec3 sky, float jitter, Cuts cuts, bool is_draft) {
  DistanceClouds clouds = marched;
  if (is_draft) {
    clouds.octaves = min(clouds.octaves, 3);
  }
  return marchDistanceCloud(origin, direction, to_light, jitter, cuts, clouds);
}
