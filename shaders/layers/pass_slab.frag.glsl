// What a slab leaves of the light.
uniform Slab slab;
uniform highp sampler2D points;
uniform vec3 to_light;
uniform float shadow_strength;
out vec4 share;

void main() {
  vec4 point = texelFetch(points, ivec2(gl_FragCoord.xy), 0);
  float fade = slabHorizonFade(to_light.y, slab);
  share = vec4(1.0);
  if (point.w > 0.0 && fade > 0.0) {
    SlabHits hits = marchSlab(point.xyz, to_light, 0.5, Cuts(0, vec2(NOWHERE), bvec2(false)), slab);
    share = vec4(mix(1.0, 1.0 - fade * hits.opacities.z, shadow_strength));
  }
}
