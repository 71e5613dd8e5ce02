// Noise wears away what is not opaque. It is fixed in the world.
uniform highp sampler2D channels;
uniform vec2 depth_range;
uniform vec3 noise_origin;
uniform float noise_size, shrink, darkening;
uniform vec2 fading;     // cells between two pixels from which the noise fades, and to which
uniform uint seed;
uniform int octaves;
uniform float gain;
out vec4 value;

float depthStep(ivec2 at, float here) {
  ivec2 size = textureSize(channels, 0);
  return abs(texelFetch(channels, clamp(at, ivec2(0), size - 1), 0).w - here);
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  value = texelFetch(channels, at, 0);
  if (!(value.z > 0.0) || value.z >= 1.0) {
    return;
  }
  vec3 view = viewDirection(gl_FragCoord.xy);
  float depth = mix(depth_range.x, depth_range.y, value.w);
  vec3 place = (eye - noise_origin + view * (depth / dot(view, forward))) / noise_size;
  float slope = max(max(depthStep(at - ivec2(1, 0), value.w), depthStep(at + ivec2(1, 0), value.w)),
                    max(depthStep(at - ivec2(0, 1), value.w), depthStep(at + ivec2(0, 1), value.w)));
  float footprint = slope * (depth_range.y - depth_range.x) / noise_size + depth * per_pixel / noise_size;
  float strength = 1.0 - smoothstep(fading.x, fading.y, footprint);
  float noise = mix(0.5, smoothstep(0.25, 0.75, fbmValue3(place, octaves, gain, seed)), strength);
  float taken = shrink * noise;
  float opacity = clamp((value.z - taken) / (1.0 - taken), 0.0, 1.0);
  float dark = 1.0 - darkening * noise * (1.0 - opacity);
  value = vec4(value.xy * dark, opacity, value.w);
}
