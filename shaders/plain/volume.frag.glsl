// The volume inside the mesh before the sky, at one sample of each pixel left or right of the divider.
uniform ivec2 sides;   // where it is drawn, left and right: 1 or 0
uniform float divider;
uniform vec2 offset;   // of the sample from the pixel's centre
uniform vec3 light_color;  // of the light that the clouds receive
out vec4 value;

void main() {
  if ((gl_FragCoord.x < divider ? sides.x : sides.y) == 0) {
    discard;
  }
  vec3 view = viewDirection(gl_FragCoord.xy + offset);
  vec3 found = lightAlong(eye, view);
  vec3 cloud = cloudColor(found.y, found.z, light_color, ambient_sky, ambient_ground);
  value = vec4(mix(skyColor(view, theSky()), cloud, found.x), 1.0);
}
