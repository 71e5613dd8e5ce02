// A part of a cloud of noise in the shadow of other things; a share of its colour comes from the sky.
uniform highp sampler2D colors, shares;
uniform vec3 sky_share;
out vec4 value;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec4 color = texelFetch(colors, at, 0);
  value = vec4(color.rgb * (sky_share + (1.0 - sky_share) * texelFetch(shares, at, 0).r), color.a);
}
