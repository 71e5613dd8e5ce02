// Clouds that shade each other and the ground by a grid of the sky's optical depth along the sun's light: the same as
// preview/mesh_clouds/shade_grid.h. The rows take a place of the world to coordinates of the grid's nodes; the first two are the same along
// the light, so that the third does not count for what is below all clouds.

// Where a place is in a 3D texture, in texels from its corner. 'shift' leads from the grid to the part of the texture that a cloud has for
// itself, which holds the light past all other clouds; it is 0.0 in a texture of the whole grid.
vec3 shadePlace(vec3 place, vec4 row_x, vec4 row_y, vec4 row_z, vec3 shift) {
  vec4 world = vec4(place, 1.0);
  return vec3(dot(row_x, world), dot(row_y, world), dot(row_z, world)) + shift + 0.5;
}

// Where a place below all clouds is in the texture of the grid's last slice, the shadow on the ground, in texels from its corner.
vec2 shadeGroundPlace(vec3 place, vec4 row_x, vec4 row_y) {
  vec4 world = vec4(place, 1.0);
  return vec2(dot(row_x, world), dot(row_y, world)) + 0.5;
}
