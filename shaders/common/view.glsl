// The direction of a place of the picture, in pixels from its bottom left corner.
uniform vec3 eye, right, up, forward;
uniform vec2 picture;      // width and height
uniform float per_pixel;   // of a pixel's side at distance 1

vec3 viewDirection(vec2 place) {
  vec2 offset = (place - 0.5 * picture) * per_pixel;
  return normalize(forward + right * offset.x + up * offset.y);
}

// Where sample number 'index' of n * n is in its pixel: pixelPlaces of preview/camera.h.
vec2 placeInPixel(int index, int n) {
  vec2 cell = vec2(float(index % n), float(index / n));
  vec2 place = (cell + (cell.yx + 0.5) / float(n)) / float(n);
  return vec2(place.x, 1.0 - place.y);
}

// The place of the sample that is drawn at 'place', such as gl_FragCoord.xy, of n * n to a pixel.
vec2 samplePlace(vec2 place, int n) {
  ivec2 pixel = ivec2(place) / n;
  ivec2 cell = ivec2(place) - pixel * n;
  return vec2(pixel) + placeInPixel((n - 1 - cell.y) * n + cell.x, n);
}
