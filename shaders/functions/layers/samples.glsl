// Samples of a march, composited from front to back in parts: preview/backdrop/sample_sum.h and Cuts of preview/layer.h.

const float NOWHERE = 1e30;  // a distance at which there is nothing

// Where a ray meets surfaces, near to far; one behind them is NOWHERE.
struct Cuts {
  int count;
  vec2 distances;
  bvec2 are_opaque;
};

// Beyond this distance nothing is seen.
float hiddenFrom(Cuts cuts) {
  if (cuts.are_opaque.x) {
    return cuts.distances.x;
  }
  if (cuts.are_opaque.y) {
    return cuts.distances.y;
  }
  return NOWHERE;
}

float cutDistance(Cuts cuts, int part) {
  return part < cuts.count ? cuts.distances[part] : NOWHERE;
}

// A distance of a part, despite rounding.
float withinPart(Cuts cuts, int part, float distance) {
  if (part < cuts.count) {
    distance = min(distance, uintBitsToFloat(floatBitsToUint(cuts.distances[part]) - 1u));
  }
  return part > 0 ? max(distance, cuts.distances[part - 1]) : distance;
}

struct SampleSum {
  float t;
  int left;
  float stop_opacity;
  Cuts cuts;
  vec4 all;  // colour and opacity from the eye to here
  float distance;
  vec4 before;  // the same to the last cut
  float distance_before;
  int part;
  bool is_hidden;
  vec4 colors[3];
  vec3 distances;
};

SampleSum startSamples(float t, int samples, float stop_opacity, Cuts cuts) {
  SampleSum sum;
  sum.t = t;
  sum.left = samples;
  sum.stop_opacity = stop_opacity;
  sum.cuts = cuts;
  sum.all = vec4(0.0);
  sum.distance = 0.0;
  sum.before = vec4(0.0);
  sum.distance_before = 0.0;
  sum.part = 0;
  sum.is_hidden = false;
  for (int i = 0; i < 3; i++) {
    sum.colors[i] = vec4(0.0);
  }
  sum.distances = vec3(NOWHERE);
  return sum;
}

bool moreSamples(SampleSum sum) {
  return sum.left > 0 && sum.all.a <= sum.stop_opacity && sum.t < 1e29 && !sum.is_hidden;
}

// The opacity of a share of a way.
float shareOfOpacity(float opacity, float share) {
  if (opacity >= 1.0) {
    return share > 0.0 ? 1.0 : 0.0;
  }
  return 1.0 - pow(1.0 - opacity, share);
}

void addSample(inout SampleSum sum, float t, vec3 color, float opacity) {
  if (opacity > 0.0) {
    float added = (1.0 - sum.all.a) * opacity;
    sum.all += vec4(color, 1.0) * added;
    sum.distance += t * added;
  }
}

void closePart(inout SampleSum sum) {
  float added = sum.all.a - sum.before.a;
  if (added > 0.0) {
    sum.colors[sum.part] = vec4((sum.all.rgb - sum.before.rgb) / added, min(added / (1.0 - sum.before.a), 1.0));
    sum.distances[sum.part] = (sum.distance - sum.distance_before) / added;
  }
  sum.before = sum.all;
  sum.distance_before = sum.distance;
  if (sum.part < sum.cuts.count) {
    sum.is_hidden = sum.cuts.are_opaque[sum.part];
  }
  sum.part++;
}

// Takes the sample at sum.t, which stands for 'distance' to the next one; NOWHERE after the last one.
void takeSample(inout SampleSum sum, vec3 color, float opacity, float distance) {
  float end = distance < 1e29 ? sum.t + distance : sum.t;
  float from = sum.t;
  for (int i = 0; i < 2; i++) {
    float cut = cutDistance(sum.cuts, sum.part);
    if (!(sum.part < sum.cuts.count && (cut < end || cut <= from))) {
      break;
    }
    cut = max(from, cut);
    float share = end > from ? (cut - from) / (end - from) : 0.0;
    addSample(sum, from, color, shareOfOpacity(opacity, share));
    opacity = shareOfOpacity(opacity, 1.0 - share);
    from = cut;
    closePart(sum);
  }
  if (!sum.is_hidden) {
    addSample(sum, from, color, opacity);
  }
  sum.t += distance;
  sum.left--;
}

void endSamples(inout SampleSum sum) {
  if (!sum.is_hidden) {
    closePart(sum);
  }
}
