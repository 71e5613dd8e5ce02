// A vertex of a placed cloud: where it is on the screen, and the light that light.vert found.
in vec3 position;
in vec4 light;
in vec3 own;  // colour, linear

uniform vec3 eye, right, up, forward;
uniform vec2 scale;  // from tangents to the screen's [-1, 1]
uniform vec2 place;  // of the sample in the pixel, less its centre, in the screen's [-1, 1]
uniform vec2 clip;   // depth on the screen: clip.x + clip.y / distance
uniform int shown;   // SHOWN of chains.js

out vec4 shade;
out vec3 from_eye;  // in the world
out vec3 own_color;

void main() {
  vec3 offset = position - eye;
  float w = dot(offset, forward);
  gl_Position = vec4(dot(offset, right) * scale.x - place.x * w, dot(offset, up) * scale.y - place.y * w, clip.x * w + clip.y, w);
  from_eye = offset;
  shade = shown < 3 ? light : ownChannels(own, shown);
  own_color = own;
}
