// Adds an impostor to the channels of clouds: addImpostors of preview/mesh_clouds/impostor.h.
uniform highp sampler2D behind;  // so far
uniform vec3 impostor_eye;       // in the impostor's own space, from its center, in radii
uniform mat3 to_own, to_world;   // the linear parts; 'to_own' leads to radii
uniform float impostor_texels, impostor_exponent, extinction, gain;
uniform float share;             // of the sun's light that comes past other things
uniform vec3 to_light;
uniform vec2 depth_range, pixel;  // pixel: of the channels, in pixels of the picture
uniform int shown;                // sun and sky; lamps, 1 and 2, which do not shine on impostors; own colours, 3 and 4, which are white
out vec4 value;

void main() {
  vec4 one = texelFetch(behind, ivec2(gl_FragCoord.xy), 0);
  value = one;
  vec3 direction = viewDirection(gl_FragCoord.xy * pixel), rest;
  vec4 own = impostorSeen(impostor_eye, to_own * direction, normalize(impostor_eye), impostor_texels, rest);
  if (rest.z > 0.0) {
    vec4 lobe = lobeInWorld(own, to_world);
    vec2 shape = vec2(impostor_exponent, 0.0);
    vec2 light = rest.x * vec2(gain * lobeTransmittance(lobe, to_light, shape, extinction),
                               lobeTransmittance(lobe, vec3(0.0, 1.0, 0.0), shape, extinction));
    light.x = min(light.x, 1.0) * share;
    if (shown > 0) {
      light = shown < 3 ? vec2(0.0) : vec2(1.0, shown == 3 ? 1.0 : 0.0);
    }
    float depth = (dot(direction, forward) * rest.y - depth_range.x) / (depth_range.y - depth_range.x);
    vec4 other = vec4(light, rest.z, max(0.0, depth));
    vec4 near = other, far = one;
    if (one.w <= other.w) {
      near = one;
      far = other;
    }
    float through = (1.0 - near.z) * far.z, opacity = near.z + through;
    value = vec4((near.xy * near.z + far.xy * through) / opacity, opacity, (near.w * near.z + far.w * through) / opacity);
  }
}
