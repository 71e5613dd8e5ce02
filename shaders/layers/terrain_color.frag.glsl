// The colour of the ground that terrain_hit.frag has met.
uniform Terrain terrain;
uniform highp sampler2D hits, hit_places, shares;
uniform int samples_per_side;
uniform vec3 to_light;
layout(location = 0) out vec4 color;
layout(location = 1) out vec4 place;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec4 hit = texelFetch(hits, at, 0);
  float distance = texelFetch(hit_places, at, 0).x;
  color = vec4(0.0);
  place = vec4(distance);
  if (distance < 1e30) {
    vec3 view = viewDirection(samplePlace(gl_FragCoord.xy, samples_per_side));
    float sun = hit.w * texelFetch(shares, at, 0).r;
    color = vec4(terrainColor(eye + view * distance, distance, hit.xyz, sun, view, to_light, terrain), 1.0);
  }
}
