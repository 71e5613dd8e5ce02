// All layers over the background, with fog by distance: composeLayers of preview/layer.h.
uniform highp sampler2D background, cloud_colors, cloud_places, ground_colors, ground_places;
uniform highp sampler2DArray part_colors, part_places;  // of clouds of noise: three parts each; the places of a cloud are one layer
uniform bool has_clouds, has_ground;
uniform int noise_clouds;
uniform int samples_per_side;  // of ground and clouds of noise
uniform float fog_density;
uniform vec3 fog_color, to_light, light_color;
uniform vec2 fog_scatter;
out vec4 value;  // linear, and the distance that motion blur follows

const int MOST = 26;  // eight clouds of noise
const float NOTHING = 1e30;
vec4 colors[MOST];
float distances[MOST];
int count;
float nearest = NOTHING;

// Keeps the layers in the order of their distances; those that are equally far stay as they came.
void addLayer(vec4 color, float distance) {
  if (!(color.a > 0.0) || count == MOST) {
    return;
  }
  if (color.a > 0.5) {
    nearest = min(nearest, distance);
  }
  int at = count;
  while (at > 0 && distances[at - 1] > distance) {
    colors[at] = colors[at - 1];
    distances[at] = distances[at - 1];
    at--;
  }
  colors[at] = color;
  distances[at] = distance;
  count++;
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec3 behind = texelFetch(background, pixel, 0).rgb;
  vec3 fog = fog_color + scatteredLight(viewDirection(gl_FragCoord.xy), to_light, light_color, fog_scatter);
  vec3 sum = vec3(0.0);
  bool is_empty = true;
  for (int i = 0; i < samples_per_side * samples_per_side; i++) {
    ivec2 at = pixel * samples_per_side + ivec2(i % samples_per_side, i / samples_per_side);
    count = 0;
    if (has_clouds) {
      addLayer(texelFetch(cloud_colors, pixel, 0), texelFetch(cloud_places, pixel, 0).x);
    }
    if (has_ground) {
      addLayer(texelFetch(ground_colors, at, 0), texelFetch(ground_places, at, 0).x);
    }
    for (int k = 0; k < noise_clouds; k++) {
      vec4 places = texelFetch(part_places, ivec3(at, k), 0);
      for (int part = 0; part < 3; part++) {
        addLayer(texelFetch(part_colors, ivec3(at, 3 * k + part), 0), places[part]);
      }
    }
    is_empty = is_empty && count == 0;
    float transparency = 1.0;
    for (int k = 0; k < count; k++) {
      vec3 color = fog_density > 0.0 ? mix(colors[k].rgb, fog, 1.0 - exp(-fog_density * distances[k])) : colors[k].rgb;
      sum += color * (transparency * colors[k].a);
      transparency *= 1.0 - colors[k].a;
    }
    sum += behind * transparency;
  }
  value = vec4(is_empty ? behind : sum / float(samples_per_side * samples_per_side), nearest);
}
