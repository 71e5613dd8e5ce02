// The clouds before the sky, at one sample of each pixel.
uniform highp sampler2D even, odd;  // light along the view and the share that comes through, after the last surface in one of the two
uniform vec2 offset;                // of the sample from the pixel's centre
out vec4 value;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec4 color = texelFetch(even, at, 0);
  vec4 other = texelFetch(odd, at, 0);
  if (other.a < color.a) {  // surfaces let less and less through
    color = other;
  }
  value = vec4(color.rgb + color.a * skyColor(viewDirection(gl_FragCoord.xy + offset), theSky()), 1.0);
}
