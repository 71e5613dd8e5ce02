#include "core/image.h"

#include "core/parallel.h"

namespace cloudbake {

Image halved(const Image& image) {
  Image half = blankImage(image.width / 2, image.height / 2);
  parallelFor(half.height, [&](int y) {
    for (int x = 0; x < half.width; ++x)
      half.at(x, y) = (image.at(2 * x, 2 * y) / 4 + image.at(2 * x + 1, 2 * y) / 4) + image.at(2 * x, 2 * y + 1) / 4 +
                      image.at(2 * x + 1, 2 * y + 1) / 4;
  });
  return half;
}

}  // namespace cloudbake
