// What marched clouds leave of the light.
uniform highp sampler2D points;
uniform vec3 to_light;
uniform float shadow_strength;
out vec4 share;

vec3 shadowAt(vec3 point) {
  return vec3(1.0);
}

void main() {
  vec4 point = texelFetch(points, ivec2(gl_FragCoord.xy), 0);
  share = vec4(1.0);
  if (point.w > 0.0) {
    Cuts none = Cuts(0, vec2(NOWHERE), bvec2(false));
    float opacity = marchClouds(point.xyz / marched.scale, to_light, to_light, vec3(0.0), 0.0, none, false).colors[0].a;
    share = vec4(mix(1.0, 1.0 - opacity, shadow_strength));
  }
}
