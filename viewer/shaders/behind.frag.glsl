// The depth of the nearest surface behind those that were drawn before.
uniform highp sampler2D nearer;  // depths

void main() {
  if (gl_FragCoord.z <= texelFetch(nearer, ivec2(gl_FragCoord.xy), 0).r) {
    discard;
  }
}
