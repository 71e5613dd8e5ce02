// Lamps and lightning: point lights and spotlights. It needs lobe.glsl. The same as preview/lamp.h. Colours are linear, lengths are world
// units.

struct Lamp {
  vec3 place;
  vec3 color;    // at distance 1, times its strength
  float range;   // no light beyond it; 0.0: without end
  float radius;  // of the source: nearer it gets no brighter
  vec3 axis;     // of a spotlight: the unit vector in which it shines
  vec2 cone;     // cosines of its inner and outer angle; (-1.0, -1.0) or less: a point light
};

// The inverse square of the distance, smoothly windowed to 0 at the range (glTF's extension KHR_lights_punctual).
float lampFalloff(float away, float range, float radius) {
  float nearest = max(max(away, radius), 1e-6);
  float share = range > 0.0 ? away / range : 0.0;
  float squared = share * share;
  return max(1.0 - squared * squared, 0.0) / (nearest * nearest);
}

// The share of a spotlight's light towards a place from which 'to_lamp' is the direction to it: 1.0 inside of the inner angle, 0.0 outside
// of the outer one (glTF's extension KHR_lights_punctual).
float lampCone(vec3 to_lamp, vec3 axis, vec2 cone) {
  float share = clamp((-dot(to_lamp, axis) - cone.y) / max(cone.x - cone.y, 0.001), 0.0, 1.0);
  return cone.y > -1.0 ? share * share : 1.0;
}

// The light of a lamp that a vertex of a cloud shows. 'lobe', 'place' and 'normal' are in the world; 'shape': k and b; 'extinction': sigma
// per world unit. No more of the cloud counts than lies before the lamp.
vec3 lampLight(Lamp lamp, vec4 lobe, vec3 place, vec3 normal, float half_lambert, vec2 shape, float extinction) {
  vec3 way = lamp.place - place;
  float away = length(way);
  vec3 to_lamp = away > 0.0 ? way / away : normal;
  float light = lampFalloff(away, lamp.range, lamp.radius) * lampCone(to_lamp, lamp.axis, lamp.cone);
  float through = exp(-extinction * min(lobeThickness(lobe, to_lamp, shape), away));
  return lamp.color * (light * surfaceFactor(normal, to_lamp, half_lambert) * through);
}
