// What mesh clouds leave of the light.
uniform highp sampler2D points;
out vec4 share;

void main() {
  vec4 point = texelFetch(points, ivec2(gl_FragCoord.xy), 0);
  share = vec4(point.w > 0.0 ? meshShare(point.xyz) : 1.0);
}
