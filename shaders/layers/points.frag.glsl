// Where the rays of a layer end: points of the world, and 1 where there is something.
uniform highp sampler2D colors, places;
uniform int part;
uniform int samples_per_side;
layout(location = 0) out vec4 point;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  float distance = texelFetch(places, at, 0)[part];
  bool is_there = texelFetch(colors, at, 0).a > 0.0 && distance < 1e30;
  point = is_there ? vec4(eye + viewDirection(samplePlace(gl_FragCoord.xy, samples_per_side)) * distance, 1.0) : vec4(0.0);
}
