// The two functions of libhwy that dispatch needs, so that the program and libcloudbake.so start without that library.
#include "late/simd_targets.h"

#ifdef CLOUDBAKE_FINDS_SIMD_TARGETS

namespace hwy {

int64_t SupportedTargets() {
  static const int64_t targets = cloudbake::supportedSimdTargets();
  return targets;
}

ChosenTarget& GetChosenTarget() {
  static ChosenTarget chosen;
  return chosen;
}

}  // namespace hwy

#endif
