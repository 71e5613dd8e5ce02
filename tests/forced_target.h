// The targets that Google Highway's kernels are compiled for, one after the other.
#pragma once

#include <hwy/targets.h>

#include <algorithm>
#include <vector>

namespace cloudbake {

// While it lives, dispatch goes to one target.
class ForcedTarget {
 public:
  explicit ForcedTarget(int64_t target) { force(target); }
  ~ForcedTarget() { force(0); }
  ForcedTarget(const ForcedTarget&) = delete;
  ForcedTarget& operator=(const ForcedTarget&) = delete;

 private:
  static void force(int64_t target) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().DeInit();
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  }
};

// The compiled targets that the CPU supports, the portable one included.
inline std::vector<int64_t> runnableTargets() {
  std::vector<int64_t> targets = hwy::SupportedAndGeneratedTargets();
  if (std::find(targets.begin(), targets.end(), HWY_EMU128) == targets.end()) targets.push_back(HWY_EMU128);
  return targets;
}

}  // namespace cloudbake
