// A vertex of a cloud of a field: a copy of a mesh that is made larger, turned about y and moved. Where it is on the screen, and how much
// light of sun and sky reaches it. The lobe and its light are turned together, so the light is turned back; and the factor of the size
// makes the thickness larger and σ smaller.
in vec3 mesh_position, mesh_normal;
in vec4 mesh_lobe;  // direction and thickness
in vec3 own;        // colour, linear
in vec4 harmonics_0, harmonics_1, harmonics_2, harmonics_3;
in vec4 cloud_place;  // and the factor of the size
in vec4 cloud_light;  // cosine and sine of the turn, what comes of the sun's light past other things, factor of the thickness times σ

in vec3 cloud_shade;  // from the coordinates of the grid by which clouds shade each other to those of the cloud's block

uniform highp sampler3D cloud_shades;  // for each cloud, what comes of the sun's light past all others
uniform vec4 shade_x, shade_y, shade_z;  // rows that take a point of the world to the coordinates of the grid
uniform vec3 eye, right, up, forward;
uniform vec2 scale;  // from tangents to the screen's [-1, 1]
uniform vec2 place;  // of the sample in the pixel, less its centre, in the screen's [-1, 1]
uniform vec2 clip;   // depth on the screen: clip.x + clip.y / distance
uniform vec3 to_light;
uniform vec2 shape;  // k and b
uniform float extinction, half_lambert, half_lambert_sky;
uniform mat3 to_own;           // from the mesh's place before it is scattered to the axes of the harmonics
uniform float own_extinction;  // for which they were made, per unit of their mesh
uniform int shown;             // SHOWN of chains.js
uniform bool of_error;         // no error is known
uniform vec2 gains;            // of the sun's term, left and right of the divider
uniform ivec2 lights;          // what the light left and right of the divider follows: lobe, or harmonics (2)

out vec4 shade;  // light of sun and sky, left and right of the divider
out vec3 from_eye;  // in the world

float transmittance(int light, vec3 towards, float sigma) {
  if (light == 2) {
    return placedHarmonicTransmittance(mat4(harmonics_0, harmonics_1, harmonics_2, harmonics_3), towards, to_own, own_extinction, sigma);
  }
  return lobeTransmittance(mesh_lobe, towards, shape, sigma);
}

float shareOfSun() {
  vec4 world = vec4(from_eye + eye, 1.0);
  vec3 at = vec3(dot(shade_x, world), dot(shade_y, world), dot(shade_z, world)) + cloud_shade;
  return cloud_light.z * texture(cloud_shades, (at + 0.5) / vec3(textureSize(cloud_shades, 0))).r;
}

vec2 shadeBy(int light, float gain, vec3 towards, float sigma) {
  float sun = min(gain * transmittance(light, towards, sigma), 1.0) * surfaceFactor(mesh_normal, towards, half_lambert) * shareOfSun();
  vec3 above = vec3(0.0, 1.0, 0.0);  // no turn about y changes it
  return vec2(sun, transmittance(light, above, sigma) * surfaceFactor(mesh_normal, above, half_lambert_sky));
}

void main() {
  float c = cloud_light.x, s = cloud_light.y;
  vec3 p = mesh_position, l = to_light;
  from_eye = cloud_place.xyz - eye + cloud_place.w * vec3(c * p.x + s * p.z, p.y, c * p.z - s * p.x);
  float w = dot(from_eye, forward);
  gl_Position = vec4(dot(from_eye, right) * scale.x - place.x * w, dot(from_eye, up) * scale.y - place.y * w, clip.x * w + clip.y, w);

  vec3 towards = vec3(c * l.x - s * l.z, l.y, c * l.z + s * l.x);
  float sigma = extinction * cloud_light.w;
  if (shown > 2) {
    shade = ownChannels(own, shown);
    return;
  }
  if (shown > 0) {
    vec3 o = mesh_lobe.xyz, n = mesh_normal;
    vec4 lobe = vec4(c * o.x + s * o.z, o.y, c * o.z - s * o.x, mesh_lobe.w * cloud_place.w);
    vec3 normal = vec3(c * n.x + s * n.z, n.y, c * n.z - s * n.x);
    vec3 lit = lampsLight(lobe, from_eye + eye, normal, half_lambert, vec2(shape.x, shape.y * cloud_place.w), sigma / cloud_place.w);
    shade = vec4(shown == 1 ? lit.xy : vec2(lit.z, 0.0), 0.0, 0.0);
    return;
  }
  shade.xy = of_error ? vec2(0.5, 0.0) : shadeBy(lights.x, gains.x, towards, sigma);
  shade.zw = lights.x == lights.y || of_error ? shade.xy : shadeBy(lights.y, gains.y, towards, sigma);
}
