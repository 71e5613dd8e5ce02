// A vertex of a placed cloud: where it is on the screen, and how much light of sun and sky reaches it.
in vec3 position;
in vec3 normal;
in vec4 lobe;  // direction and thickness, in the world

uniform vec3 eye, right, up, forward;
uniform vec2 scale;     // from tangents to the screen's [-1, 1]
uniform vec2 place;     // of the sample in the pixel, less its centre, in the screen's [-1, 1]
uniform vec2 clip;      // depth on the screen: clip.x + clip.y / distance
uniform vec3 to_sun;
uniform vec2 shape;     // k and b
uniform float extinction, half_lambert;

out vec3 field;  // light of the sun, light of the sky, distance along the view

void main() {
  vec3 offset = position - eye;
  float w = dot(offset, forward);
  gl_Position = vec4(dot(offset, right) * scale.x - place.x * w, dot(offset, up) * scale.y - place.y * w, clip.x * w + clip.y, w);
  float sun = lobeTransmittance(lobe, to_sun, shape, extinction) * surfaceFactor(normal, to_sun, half_lambert);
  field = vec3(sun, lobeTransmittance(lobe, vec3(0.0, 1.0, 0.0), shape, extinction), w);
}
