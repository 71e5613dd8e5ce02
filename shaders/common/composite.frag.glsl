// The clouds over the sky, in the 8 bits of the screen.
uniform highp sampler2D background;
uniform float exposure;
out vec4 value;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec3 color = texelFetch(background, at, 0).rgb;
  vec4 p = channelsAt(channels, at);
  if (p.z > 0.0) {
    vec3 view = viewDirection(vec2(at) + 0.5);
    color = mix(color, inFog((litCloud(p, view) + lampsAt(at)) * ownColor(at), p, view, at), p.z);
  }
  ivec2 from_top = ivec2(at.x, int(picture.y) - 1 - at.y);
  value = vec4(toneMap(color, exposure) + ditherOffset(from_top), 1.0);
}
