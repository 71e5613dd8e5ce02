// The shadow of a cloud on other things, from the picture that "cloudbake shadow" writes: the share of light that comes through the cloud,
// seen from the sun. The names are those of the frame in the JSON beside the picture. The same as preview/mesh_clouds/shadow_frame.h.

// Where a place of the world is in the picture, 0 to 1 from the lower left; outside there is no shadow. Of a texture whose rows begin at
// the top, the row is 1.0 - y.
vec2 shadowPlace(vec3 place, vec3 origin, vec3 right_over_width, vec3 up_over_height) {
  vec3 way = place - origin;
  return vec2(dot(way, right_over_width) + 0.5, dot(way, up_over_height) + 0.5);
}

// How much of the shadow counts at a place: 0.0 at the 'top' of the cloud, towards the sun, and above it; 1.0 at its 'bottom' and below.
// 'top' and 'bottom' are lengths from the origin along 'to_sun'. Multiply the strength of shadowFactor by it where things may be above
// the cloud.
float shadowDepth(vec3 place, vec3 origin, vec3 to_sun, float top, float bottom) {
  return clamp((top - dot(place - origin, to_sun)) / max(top - bottom, 1e-6), 0.0, 1.0);
}

// The share of the sun's light that comes to a place. 'transmittance' is what the picture has at 'at', its shadowPlace; 'strength' is 0.0
// to 1.0. Outside of the picture it is 1.0.
float shadowFactor(float transmittance, vec2 at, float strength) {
  bool inside = at.x >= 0.0 && at.x <= 1.0 && at.y >= 0.0 && at.y <= 1.0;
  return inside ? 1.0 - strength * (1.0 - transmittance) : 1.0;
}
