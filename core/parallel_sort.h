// Sorts on several processors. Apart from core/parallel.h, because TBB's headers take longer to compile than most files that only loop.
#pragma once

#include <algorithm>
#ifndef CLOUDBAKE_SERIAL
#include <tbb/parallel_sort.h>
#endif

namespace cloudbake {

/// Sorts values among which no two are equal.
template <class Iterator, class Less>
void parallelSort(Iterator begin, Iterator end, const Less& less) {
#ifdef CLOUDBAKE_SERIAL
  std::sort(begin, end, less);
#else
  tbb::parallel_sort(begin, end, less);
#endif
}

}  // namespace cloudbake
