// A sky without a night.
vec3 theSkyColor(vec3 view) {
  return skyColor(view, theSky());
}
