// Reads the atlas of an impostor as preview/mesh_clouds/impostor.cpp does. Needs impostor.glsl, and before it the uniforms
//   sampler2D impostor_lobe, impostor_rest: linear values, without premultiplied alpha, clamped, with mip levels
//   vec4 impostor_atlas: views, pixels to a side of a frame, the last mip level, the thickness of the value 1.0

// Adds what a ray sees in a frame: lobes times weights; the light, the distance from 'place' in lengths of the ray, and the opacity times
// the weight of the frame.
void addImpostorFrame(vec2 frame, float weight, vec3 place, vec3 ray, float level, inout vec4 lobes, inout vec3 rest) {
  vec3 to_eye = impostorDirection(frame, impostor_atlas.x);
  if (weight > 0.0 && dot(ray, to_eye) < 0.0) {
    vec3 right = impostorRight(to_eye);
    vec2 flat_place = impostorPlace(place + ray * impostorReach(place, ray, to_eye, 0.0), right, to_eye);
    vec4 first = textureLod(impostor_rest, impostorInAtlas(flat_place, frame, impostor_atlas.x, impostor_atlas.y), level);
    vec2 at = impostorPlace(place + ray * impostorReach(place, ray, to_eye, impostorHeight(first.z)), right, to_eye);
    if (at.x >= 0.0 && at.x <= 1.0 && at.y >= 0.0 && at.y <= 1.0) {
      vec2 in_atlas = impostorInAtlas(at, frame, impostor_atlas.x, impostor_atlas.y);
      vec4 other = textureLod(impostor_rest, in_atlas, level);
      vec4 lobe = textureLod(impostor_lobe, in_atlas, level);
      float share = weight * other.y;
      lobes += share * impostorLobe(lobe.xyz, right, to_eye, impostor_atlas.w);
      rest += share * vec3(other.x, impostorReach(place, ray, to_eye, impostorHeight(other.z)), 1.0);
    }
  }
}

// What a ray through a place sees: returns the mean lobe, and gives light, distance and opacity. Where the opacity is 0.0 there is nothing
// else. 'to_eye': the direction from the center to the eye; 'texels': of the finest level per pixel of the picture.
vec4 impostorSeen(vec3 place, vec3 ray, vec3 to_eye, float texels, out vec3 light_distance_opacity) {
  vec4 cell = impostorCell(to_eye, impostor_atlas.x);
  vec3 weights = impostorWeights(cell, impostor_atlas.x);
  float level = impostorLevel(texels, impostor_atlas.z);
  vec4 lobes = vec4(0.0);
  vec3 rest = vec3(0.0);
  addImpostorFrame(cell.xy + impostorFirst(cell, impostor_atlas.x), weights.x, place, ray, level, lobes, rest);
  addImpostorFrame(cell.xy + impostorSecond(cell, impostor_atlas.x), weights.y, place, ray, level, lobes, rest);
  addImpostorFrame(cell.xy + impostorThird(cell, impostor_atlas.x), weights.z, place, ray, level, lobes, rest);
  light_distance_opacity = vec3(0.0);
  if (!(rest.z > 0.0)) {
    return vec4(0.0, -1.0, 0.0, 0.0);
  }
  light_distance_opacity = vec3(rest.xy / rest.z, rest.z);
  return impostorMean(lobes, rest.z);
}
