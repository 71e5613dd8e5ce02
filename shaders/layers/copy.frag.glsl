// An image as it is.
uniform highp sampler2D image;
out vec4 value;

void main() {
  value = texelFetch(image, ivec2(gl_FragCoord.xy), 0);
}
