// The clouds before the sky, at one sample of each pixel.
uniform highp sampler2D color;  // light along the view, and the share that comes through
uniform bool is_empty;
uniform vec2 offset;            // of the sample from the pixel's centre
out vec4 value;

void main() {
  vec4 cloud = is_empty ? vec4(0.0, 0.0, 0.0, 1.0) : texelFetch(color, ivec2(gl_FragCoord.xy), 0);
  value = vec4(cloud.rgb + cloud.a * skyColor(viewDirection(gl_FragCoord.xy + offset), theSky()), 1.0);
}
