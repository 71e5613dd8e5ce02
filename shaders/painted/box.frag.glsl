// The mean over a box along one axis: the image is constant over each pixel, and boxes end at the border. The half width, in pixels,
// follows the depth from near to far.
uniform highp sampler2D image, channels;
uniform ivec2 axis;
uniform float near_half, far_half;
out vec4 value;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  ivec2 size = textureSize(image, 0);
  float depth = min(texelFetch(channels, at, 0).w, 1.0);
  float half_width = max(0.5, mix(near_half, far_half, depth));
  float center = float(at.x * axis.x + at.y * axis.y) + 0.5;
  float low = max(0.0, center - half_width);
  float high = min(float(size.x * axis.x + size.y * axis.y), center + half_width);
  vec4 sum = vec4(0.0);
  for (int i = int(floor(low)); i < int(ceil(high)); i++) {
    float weight = min(high, float(i) + 1.0) - max(low, float(i));
    sum += weight * texelFetch(image, at + (i - int(center)) * axis, 0);
  }
  value = sum / (high - low);
}
