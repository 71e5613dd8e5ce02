// What is done to a developed picture: preview/grade.h.
// The members of a 'struct NAME;' are the keys of its settings there (preview/backdrop/glsl_structs.h).

struct Vignette;
struct Contrast;

// 'place' is 0 to 1 across the picture.
float vignetteFactor(vec2 place, Vignette s) {
  float inside = max(0.0, 16.0 * place.x * place.y * (1.0 - place.x) * (1.0 - place.y));
  return s.vignette + (1.0 - s.vignette) * pow(inside, s.vignette_exponent);
}

vec3 contrastColor(vec3 color, Contrast s) {
  vec3 c = clamp(color, 0.0, 1.0);
  return mix(c, c * c * (3.0 - 2.0 * c), s.contrast) + s.lift;
}
