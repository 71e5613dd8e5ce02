#include "io/sculpt/vertex_colors.h"

#include <cmath>

#include "core/srgb.h"

namespace cloudbake {

float fullColor(float largest) { return largest <= 1 ? 1 : largest <= 255 ? 255 : 65535; }

void decodeVertexColors(std::vector<VertexColor>& colors, float full) {
  for (VertexColor& color : colors)
    if (color[3] >= 0)
      for (size_t i = 0; i < 3; ++i) color[i] = linearOfSrgb(color[i] / full);
}

void decodeVertexColors(std::vector<VertexColor>& colors) {
  float largest = 0;
  for (const VertexColor& color : colors)
    for (size_t i = 0; i < 3 && color[3] >= 0; ++i) largest = std::fmax(largest, color[i]);
  decodeVertexColors(colors, fullColor(largest));
}

}  // namespace cloudbake
