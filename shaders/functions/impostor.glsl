// Lobe impostors: which frames of the atlas are seen, where a ray meets them, and what their texels mean. The same as core/impostor.h and
// preview/mesh_clouds/impostor.cpp. Places are in the impostor's own space, from the center of its ball, in radii of the ball. Textures
// are read by whoever calls this; shaders/common/impostor_atlas.glsl does it. Needs lobe.glsl.

float octahedralSign(float x) {
  return x < 0.0 ? -1.0 : 1.0;
}

// A direction as a place of an octahedron's map, -1 to 1, whose middle is +z. octahedralDirection of lobe.glsl is the way back.
vec2 octahedralPlace(vec3 direction) {
  vec3 sizes = abs(direction);
  vec2 at = direction.xy / (sizes.x + sizes.y + sizes.z);
  if (direction.z >= 0.0) {
    return at;
  }
  return vec2((1.0 - abs(at.y)) * octahedralSign(at.x), (1.0 - abs(at.x)) * octahedralSign(at.y));
}

// The direction to the eye from which a frame is seen; 'frame': how many frames it is from the left and from the top.
vec3 impostorDirection(vec2 frame, float views) {
  vec2 middle = frame * 2.0 / (views - 1.0) - 1.0;
  vec3 direction = octahedralDirection(middle);
  return direction.xzy;
}

// The cell of four frames around a direction to the eye, a unit vector: xy is its first frame, zw the place in it, 0 to 1. The frames that
// are seen are at the corners of one of its two triangles: xy + impostorFirst(…), xy + impostorSecond(…) and xy + impostorThird(…).
vec4 impostorCell(vec3 to_eye, float views) {
  float last = views - 1.0;
  vec2 half_way = octahedralPlace(to_eye.xzy) * 0.5 + 0.5;
  vec2 place = clamp(half_way * last, 0.0, last);
  vec2 first = min(floor(place), last - 1.0);
  return vec4(first, place - first);
}

// Whether the diagonal from the upper right divides the cell: the one along which the octahedron has an edge's length.
bool impostorFalls(vec4 cell, float views) {
  return (2.0 * cell.x + 1.0 < views - 1.0) == (2.0 * cell.y + 1.0 < views - 1.0);
}

vec2 impostorFirst(vec4 cell, float views) {
  return impostorFalls(cell, views) && cell.z + cell.w >= 1.0 ? vec2(1.0, 1.0) : vec2(0.0, 0.0);
}

vec2 impostorSecond(vec4 cell, float views) {
  return impostorFalls(cell, views) || cell.z > cell.w ? vec2(1.0, 0.0) : vec2(0.0, 1.0);
}

vec2 impostorThird(vec4 cell, float views) {
  return impostorFalls(cell, views) ? vec2(0.0, 1.0) : vec2(1.0, 1.0);
}

// How much each of the three counts.
vec3 impostorWeights(vec4 cell, float views) {
  float u = cell.z;
  float v = cell.w;
  if (!impostorFalls(cell, views)) {
    return vec3(1.0 - max(u, v), abs(u - v), min(u, v));
  }
  if (u + v < 1.0) {
    return vec3(1.0 - u - v, u, v);
  }
  return vec3(u + v - 1.0, 1.0 - v, 1.0 - u);
}

// To the right in a picture that is seen from a direction. The third axis, upwards, is cross(to_eye, right).
vec3 impostorRight(vec3 to_eye) {
  if (abs(to_eye.y) < 0.9999) {
    return vec3(to_eye.z, 0.0, -to_eye.x) / sqrt(to_eye.x * to_eye.x + to_eye.z * to_eye.z);
  }
  return vec3(1.0, 0.0, 0.0);
}

// How far a ray is from one of its places to a height over the plane of a frame, in lengths of the ray.
float impostorReach(vec3 place, vec3 ray, vec3 to_eye, float height) {
  return (height - dot(place, to_eye)) / dot(ray, to_eye);
}

// The height that a texel's depth stands for: 1.0 is nearest to the eye.
float impostorHeight(float depth) {
  return 1.0 - 2.0 * depth;
}

// Where a place is in the picture of a frame, 0 to 1 from its upper left corner.
vec2 impostorPlace(vec3 place, vec3 right, vec3 to_eye) {
  return vec2(0.5 + 0.5 * dot(place, right), 0.5 - 0.5 * dot(place, cross(to_eye, right)));
}

// The same in the atlas, 0 to 1, clamped so that no other frame is read. 'pixels': to a side of a frame.
vec2 impostorInAtlas(vec2 at, vec2 frame, float views, float pixels) {
  float edge = 0.5 / pixels;
  return (frame + clamp(at, edge, 1.0 - edge)) / views;
}

// The mip level of the atlas. 'texels': of the finest level per pixel of the picture; 'last': the last level.
float impostorLevel(float texels, float last) {
  return clamp(log2(max(texels, 1e-6)), 0.0, last);
}

// The lobe of a texel: the direction o, and the thickness d in the impostor's own units. 'thickest': d of the value 1.0.
vec4 impostorLobe(vec3 texel, vec3 right, vec3 to_eye, float thickest) {
  vec2 at = texel.xy * 2.0 - 1.0;
  vec3 d = octahedralDirection(at);
  return vec4(right * d.x + cross(to_eye, right) * d.y - to_eye * d.z, texel.z * texel.z * thickest);
}

// The mean of lobes, from their sum and that of their weights.
vec4 impostorMean(vec4 sum, float weights) {
  float size = length(sum.xyz);
  vec3 direction = vec3(0.0, -1.0, 0.0);
  if (size > 0.0) {
    direction = sum.xyz / size;
  }
  return vec4(direction, sum.w / weights);
}

// A corner of the square on which the impostor is drawn: through the center, turned to the eye, and so large that the ball is in it.
// 'own_eye' is the place of the eye, or without perspective any vector towards the camera. Within the ball the square has no size. What
// frames show beyond the ball needs the margin of 1.1.
vec3 impostorCorner(vec2 corner, vec3 own_eye, bool has_perspective) {
  float away = length(own_eye);
  vec3 to_eye = own_eye / away;
  vec3 right = impostorRight(to_eye);
  float reach = 1.1;
  if (has_perspective) {
    reach = away > 1.0 ? 1.1 * away / sqrt(away * away - 1.0) : 0.0;
  }
  return (right * corner.x + cross(to_eye, right) * corner.y) * reach;
}

// The ray through a place of that square.
vec3 impostorRay(vec3 place, vec3 own_eye, bool has_perspective) {
  if (has_perspective) {
    return place - own_eye;
  }
  return -normalize(own_eye);
}

// Texels of the finest level per pixel of the picture. 'side': of a pixel in the distance of the center, and 'radius', both in the world;
// 'pixels': to a side of a frame.
float impostorTexels(float side, float radius, float pixels) {
  return side / (2.0 * radius) * pixels;
}
