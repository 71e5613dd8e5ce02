// The terrain's own sky: the mean over the samples of a pixel.
uniform Terrain terrain;
uniform vec3 to_sun;
uniform int samples_per_side;
out vec4 value;

void main() {
  vec3 sum = vec3(0.0);
  for (int i = 0; i < samples_per_side * samples_per_side; i++) {
    sum += terrainSky(eye, viewDirection(floor(gl_FragCoord.xy) + placeInPixel(i, samples_per_side)), to_sun, terrain);
  }
  value = vec4(sum / float(samples_per_side * samples_per_side), 1.0);
}
