// The loop over a picture. Each row writes only its own pixels, so the bytes are the same for any number of threads.
#pragma once

#include "core/parallel.h"

namespace cloudbake {

/// Calls row(y) for every y in [0, height), on several threads.
template <typename Row>
void forEachRow(int height, const Row& row) {
  parallelBlocks(0, height, 1, [&row](int top, int bottom) {
    for (int y = top; y < bottom; ++y) row(y);
  });
}

}  // namespace cloudbake
