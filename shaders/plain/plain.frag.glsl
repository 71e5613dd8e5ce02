// The mean over the samples, and the sky where no cloud can be, in the 8 bits of the screen.
uniform highp sampler2D sums, background;
uniform float share, exposure;
uniform ivec4 box;
uniform vec2 picture;
out vec4 value;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  bool is_cloud = at.x >= box.x && at.y >= box.y && at.x < box.z && at.y < box.w;
  vec3 color = is_cloud ? texelFetch(sums, at, 0).rgb / share : texelFetch(background, at, 0).rgb;
  value = vec4(toneMap(color, exposure) + ditherOffset(ivec2(at.x, int(picture.y) - 1 - at.y)), 1.0);
}
