// The loop over a picture. Each row writes only its own pixels, so the bytes are the same for any number of threads.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace cloudbake {

/// Calls row(y) for every y in [0, height), on several threads.
template <typename Row>
void forEachRow(int height, const Row& row) {
  tbb::parallel_for(tbb::blocked_range<int>(0, height), [&row](const tbb::blocked_range<int>& rows) {
    for (int y = rows.begin(); y < rows.end(); ++y) row(y);
  });
}

}  // namespace cloudbake
