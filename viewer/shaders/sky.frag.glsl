// The sky at the pixels' centres.
out vec4 value;

void main() {
  value = vec4(skyColor(viewDirection(gl_FragCoord.xy), theSky()), 1.0);
}
