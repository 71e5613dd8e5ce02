// Marched clouds as a layer, in parts before, between and behind surfaces.
uniform vec3 to_light, sky_share;
uniform float fewer;  // 1, or more while something moves

vec3 shadowAt(vec3 point) {
  return sky_share + (1.0 - sky_share) * meshShare(point * marched.scale);
}

void main() {
  Cuts cuts = cutsAt(ivec2(gl_FragCoord.xy), samples_per_side);
  vec3 view = viewDirection(samplePlace(gl_FragCoord.xy, samples_per_side));
  float jitter = marched.dither * jitterAt(marched.seed);
  writeParts(marchClouds(eye / marched.scale, view, to_light, theSkyColor(view), jitter, scaledCuts(cuts, marched.scale), fewer > 1.0),
             cuts, marched.scale);
}
