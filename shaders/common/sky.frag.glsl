// The sky at the pixels' centres.
out vec4 value;

void main() {
  value = vec4(theSkyColor(viewDirection(gl_FragCoord.xy)), 1.0);
}
