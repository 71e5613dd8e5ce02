// The direction of a place of the picture, in pixels from its bottom left corner.
uniform vec3 eye, right, up, forward;
uniform vec2 picture;      // width and height
uniform float per_pixel;   // of a pixel's side at distance 1

vec3 viewDirection(vec2 place) {
  vec2 offset = (place - 0.5 * picture) * per_pixel;
  return normalize(forward + right * offset.x + up * offset.y);
}
