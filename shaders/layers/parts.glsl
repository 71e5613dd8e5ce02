// What a march through clouds has found, in parts before, between and behind surfaces.
uniform int samples_per_side;
layout(location = 0) out vec4 color_0;
layout(location = 1) out vec4 color_1;
layout(location = 2) out vec4 color_2;
layout(location = 3) out vec4 places;

// The random share of the first step of a sample, and the cuts along its ray.
float jitterAt(uint seed) {
  ivec2 at = ivec2(gl_FragCoord.x, picture.y * float(samples_per_side) - gl_FragCoord.y);
  ivec2 pixel = at / samples_per_side;
  ivec2 in_pixel = at - pixel * samples_per_side;
  uvec2 of_pixel = hashDraw(pixelStream(seed), uint(pixel.x), uint(pixel.y));
  return uniformFloat(hashDraw(of_pixel, uint(in_pixel.y * samples_per_side + in_pixel.x), 0u));
}

Cuts scaledCuts(Cuts cuts, float scale) {
  cuts.distances /= scale;
  return cuts;
}

void writeParts(SampleSum sum, Cuts cuts, float scale) {
  color_0 = sum.colors[0];
  color_1 = sum.colors[1];
  color_2 = sum.colors[2];
  vec4 met = vec4(NOWHERE);
  for (int i = 0; i < 3; i++) {
    if (sum.colors[i].a > 0.0) {
      met[i] = withinPart(cuts, i, sum.distances[i] * scale);
    }
  }
  places = met;
}
