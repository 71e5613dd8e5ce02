// Thin dust: preview/backdrop/dust.h. It needs light.glsl, random.glsl, samples.glsl and shading.glsl.
// The members of a 'struct NAME;' are the keys of its settings there (preview/backdrop/glsl_structs.h).

struct Dust;

// The part of a ray in the unit ball, from x to y; x is NOWHERE if it misses the ball.
vec2 chordOf(vec3 from, vec3 along) {
  float a = dot(along, along);
  if (!(a > 0.0)) {
    return vec2(NOWHERE, 0.0);
  }
  // From the point of the ray that is nearest to the centre, where the squares are small.
  float nearest = -dot(from, along) / a;
  vec3 middle = from + along * nearest;
  float square = (1.0 - dot(middle, middle)) / a;
  if (!(square > 0.0)) {
    return vec2(NOWHERE, 0.0);
  }
  float enter = max(0.0, nearest - sqrt(square));
  float leave = nearest + sqrt(square);
  return leave > enter ? vec2(enter, leave) : vec2(NOWHERE, 0.0);
}

// How much of the sun's and of the sky's light comes to a point. Of the program.
vec2 dustLight(vec3 point);

// Marches from 'eye'. 'ball': rows of the way to the unit ball; 'longest': the box's longest side, world units; 'jitter': where in a step
// its sample is, -0.5 to 0.5.
SampleSum marchDust(vec3 eye, vec3 view, mat4 ball, float longest, vec3 to_light, vec3 sun, vec3 sky, float jitter, Cuts cuts, Dust dust) {
  vec2 chord = chordOf((vec4(eye, 1.0) * ball).xyz, (vec4(view, 0.0) * ball).xyz);
  SampleSum sum = startSamples(chord.x, dust.samples, 1.0, cuts);
  if (chord.x >= NOWHERE) {
    return sum;
  }
  vec3 from_sun = sun * henyeyGreenstein(dot(view, to_light), dust.asymmetry);
  vec3 from_sky = sky * dust.ambient;
  float distance = (chord.y - chord.x) / float(dust.samples);
  while (moreSamples(sum)) {
    vec3 point = eye + view * (sum.t + (0.5 + jitter) * distance);
    float full = smoothStep(1.0, dust.fade_start, length((vec4(point, 1.0) * ball).xyz));
    float opacity = 1.0 - exp(-dust.thickness / longest * full * distance);
    vec3 color = vec3(0.0);
    if (opacity > 0.0) {
      vec2 light = dustLight(point);
      color = dust.color * (from_sun * light.x + from_sky * light.y);
    }
    takeSample(sum, color, opacity, distance);
  }
  endSamples(sum);
  return sum;
}
