// Where rays meet the ground: its normal and the share of the sun past the ground itself, and the distance.
uniform Terrain terrain;
uniform int samples_per_side;
uniform vec3 to_light;
uniform float fewer;  // 1, or more while something moves
layout(location = 0) out vec4 hit;
layout(location = 1) out vec4 place;

void main() {
  Terrain ground = terrain;
  if (fewer > 1.0) {
    ground.shape.normal_octaves = min(ground.shape.normal_octaves, 9);
    ground.march.tolerance = max(ground.march.tolerance, 0.004);
  }
  vec3 view = viewDirection(samplePlace(gl_FragCoord.xy, samples_per_side));
  float distance = marchTerrain(eye, view, ground);
  hit = vec4(0.0);
  place = vec4(1e30);
  if (distance >= 0.0) {
    vec3 point = eye + view * distance;
    vec3 normal = terrainNormal(point.xz, ground.march.normal_step * distance, ground);
    hit = vec4(normal, dot(normal, to_light) > 0.0 ? terrainShadow(point, to_light, ground) : 0.0);
    place = vec4(distance);
  }
}
