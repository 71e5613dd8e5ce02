// What the numbers of vertex colours mean. Only for io/sculpt/*.cpp.
#pragma once

#include <array>
#include <vector>

namespace cloudbake {

using VertexColor = std::array<float, 4>;  ///< red, green, blue, alpha

/// The number of full intensity in a file whose largest number is `largest`: 1, 255 or 65535.
float fullColor(float largest);

/// Turns colours as a file has them into linear ones, as in COLOR_0 of glTF. Red, green and blue are sRGB: so Blender, MeshLab and three.js
/// write and read the colours of OBJ, PLY, Collada and FBX. `full` is the number of full intensity. Colours with an alpha below 0 (none)
/// are left alone.
void decodeVertexColors(std::vector<VertexColor>& colors, float full);

/// The same, with the full intensity that the largest number of all colours says.
void decodeVertexColors(std::vector<VertexColor>& colors);

}  // namespace cloudbake
