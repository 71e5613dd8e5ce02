// Small functions for shading: preview/shading_math.h.

// Hermite's step from 0 at 'a' to 1 at 'b'; reversed where a is over b, which GLSL's own smoothstep leaves undefined.
float smoothStep(float a, float b, float x) {
  float t = clamp((x - a) / (b - a), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}
