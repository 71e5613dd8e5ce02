// The error of T at the surface, as colours: blue where the cloud is too dark, red where it is too light, white where it is right.
uniform highp sampler2D channels;
uniform vec2 picture;
out vec4 value;

void main() {
  vec4 drawn = texelFetch(channels, ivec2(gl_FragCoord.xy * vec2(textureSize(channels, 0)) / picture), 0);
  vec3 darker = vec3(0.02, 0.19, 0.51);
  vec3 lighter = vec3(0.50, 0.02, 0.10);
  float error = 2.0 * drawn.x - 1.0;
  vec3 color = mix(vec3(0.97), error < 0.0 ? darker : lighter, sqrt(min(abs(error), 1.0)));
  value = vec4(mix(vec3(0.45), color, drawn.z), 1.0);
}
