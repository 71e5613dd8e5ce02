// From each key, the next one is as far away as all frames between are near enough. Each distance is tried first that the key before had,
// and every frame between the keys that are chosen has been compared.
#include "pipeline/sequence/choose_keys.h"

#include <algorithm>
#include <atomic>
#include <numeric>
#include <optional>
#include <utility>

#include "bake/lobe/sweep.h"
#include "bake/sequence/follow_surface.h"
#include "bake/truth/error_metrics.h"
#include "core/parallel.h"
#include "preview/compare/popping.h"

namespace cloudbake {

namespace {

constexpr int kLights = 32;

class Chooser {
 public:
  Chooser(const CloudSequence& sequence, const SequenceSegment& all, int pixels, double most_change)
      : sequence_(sequence),
        all_(all),
        most_(most_change),
        lights_(bothSenses(sweepAxes(kLights))),
        pictures_(boxOf({&all, 1}), pixels),
        own_(all.keys.size()) {
    parallelFor(own_.size(), [&](size_t i) { own_[i] = pictures_.of(meshOf(sequence_, all_, all_.keys[i])); });
  }

  std::vector<size_t> choose(std::vector<BlendFigures>& figures) const {
    figures.assign(all_.keys.size(), {});
    std::vector<size_t> keys{0};
    const size_t last = all_.keys.size() - 1;
    for (size_t step = 1; keys.back() < last;) {
      const size_t from = keys.back(), most = last - from;
      step = std::min(step, most);
      auto changes = changesIfNear(from, from + step);
      while (changes && step < most) {
        auto farther = changesIfNear(from, from + step + 1);
        if (!farther) break;
        changes = std::move(farther), ++step;
      }
      while (!changes) changes = changesIfNear(from, from + --step);  // the next frame is near: nothing lies between
      const size_t to = from + step;
      keys.push_back(to);
      parallelFor(from + 1, to, [&](size_t i) { figures[i] = {(*changes)[i - from - 1], transmittanceRms(i, from, to)}; });
    }
    return keys;
  }

 private:
  SequenceKey blended(size_t frame, size_t from, size_t to) const {
    return blendedKey(all_.keys[from], all_.keys[to], all_.keys[frame].frame);
  }

  // The changes of the frames between two keys, unless one is too large. Those that moved farthest from the blend come first, because they
  // are the most likely to be too far.
  std::optional<std::vector<double>> changesIfNear(size_t from, size_t to) const {
    std::vector<std::pair<double, size_t>> between;
    for (size_t i = from + 1; i < to; ++i) between.emplace_back(-rmsBetween(blended(i, from, to).positions, all_.keys[i].positions), i);
    std::sort(between.begin(), between.end());
    std::vector<double> changes(between.size());
    constexpr size_t kTogether = 4;
    for (size_t first = 0; first < between.size(); first += kTogether) {
      std::atomic<bool> is_near = true;
      parallelFor(first, std::min(first + kTogether, between.size()), [&](size_t i) {
        const size_t frame = between[i].second;
        changes[frame - from - 1] = changeAt(frame, from, to);
        if (changes[frame - from - 1] > most_) is_near = false;
      });
      if (!is_near) return std::nullopt;
    }
    return changes;
  }

  double changeAt(size_t frame, size_t from, size_t to) const {
    return SidePictures::rmsBetween(own_[frame], pictures_.of(meshOf(sequence_, all_, blended(frame, from, to))));
  }

  double transmittanceRms(size_t frame, size_t from, size_t to) const {
    const AssetInfo& info = sequence_.info;
    return compareLobeTransmittance(blended(frame, from, to).lobes, all_.keys[frame].lobes, info.shape, lights_, info.extinction).rms;
  }

  const CloudSequence& sequence_;
  const SequenceSegment& all_;
  double most_;
  std::vector<Vec3> lights_;
  SidePictures pictures_;
  std::vector<SidePictures::Taken> own_;
};

}  // namespace

std::vector<size_t> chooseKeys(const CloudSequence& sequence, const SequenceSegment& all, int pixels, double most_change,
                               std::vector<BlendFigures>& figures) {
  if (!(most_change > 0)) {
    figures.assign(all.keys.size(), {});
    std::vector<size_t> keys(all.keys.size());
    std::iota(keys.begin(), keys.end(), size_t(0));
    return keys;
  }
  return Chooser(sequence, all, pixels, most_change).choose(figures);
}

}  // namespace cloudbake
