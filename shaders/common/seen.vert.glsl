// The light that an eye sees of the volume through a vertex.
in vec3 position;
uniform vec3 eye;
out vec2 light_seen;

void main() {
  light_seen = lightAlong(position, normalize(position - eye)).yz;
}
