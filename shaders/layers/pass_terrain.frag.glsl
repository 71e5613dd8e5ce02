// What the ground leaves of the light.
uniform Terrain terrain;
uniform highp sampler2D points;
uniform vec3 to_light;
out vec4 share;

void main() {
  vec4 point = texelFetch(points, ivec2(gl_FragCoord.xy), 0);
  share = vec4(point.w > 0.0 ? passTerrain(point.xyz, to_light, terrain) : 1.0);
}
