// One channel as grey, with unchanged values.
uniform highp sampler2D channels;
uniform vec2 picture;
uniform int channel;
out vec4 value;

void main() {
  vec2 size = vec2(textureSize(channels, 0));
  value = vec4(vec3(texelFetch(channels, ivec2(gl_FragCoord.xy * size / picture), 0)[channel]), 1.0);
}
