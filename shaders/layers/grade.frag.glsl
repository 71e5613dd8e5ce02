// The last steps to the 8 bits of the screen.
uniform highp sampler2D developed;
uniform bool has_vignette, has_contrast;
uniform Vignette vignette;
uniform Contrast contrast;
uniform vec2 picture;
out vec4 value;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec3 color = texelFetch(developed, at, 0).rgb;
  if (has_vignette) {
    color *= vignetteFactor(gl_FragCoord.xy / picture, vignette);
  }
  if (has_contrast) {
    color = contrastColor(color, contrast);
  }
  value = vec4(color + ditherOffset(ivec2(at.x, int(picture.y) - 1 - at.y)), 1.0);
}
