// The terrain's own sky: the mean over the samples of a pixel.
uniform Terrain terrain;
uniform int samples_per_side;
out vec4 value;

void main() {
  vec3 sum = vec3(0.0);
  for (int i = 0; i < samples_per_side * samples_per_side; i++) {
    vec2 place = (vec2(i % samples_per_side, i / samples_per_side) + 0.5) / float(samples_per_side);
    sum += terrainSky(eye, viewDirection(floor(gl_FragCoord.xy) + place), to_sun, terrain);
  }
  value = vec4(sum / float(samples_per_side * samples_per_side), 1.0);
}
