// The light of all lamps at a vertex. Four vectors are a lamp: place and range; colour and radius; axis and the cosine of the inner angle;
// that of the outer angle.
uniform vec4 lamps[64];
uniform int lamp_count;

vec3 lampsLight(vec4 lobe, vec3 place, vec3 normal, float half_lambert, vec2 shape, float extinction) {
  vec3 sum = vec3(0.0);
  for (int i = 0; i < 4 * lamp_count; i += 4) {
    Lamp lamp = Lamp(lamps[i].xyz, lamps[i + 1].xyz, lamps[i].w, lamps[i + 1].w, lamps[i + 2].xyz, vec2(lamps[i + 2].w, lamps[i + 3].x));
    sum += lampLight(lamp, lobe, place, normal, half_lambert, shape, extinction);
  }
  return sum;
}
