// Samples of a march, composited from front to back.
// Samples are composited from front to back, with T_i = Π_{j<i} (1 − a_j):
//   opacity A = Σ T_i a_i,  colour Σ T_i a_i c_i / A,  distance Σ T_i a_i t_i / A.
// Of the part between two cuts, where A has grown from A₁ to A₂, the opacity alone is (A₂ − A₁)/(1 − A₁): the parts over each other are the
// whole.
#pragma once

#include <algorithm>
#include <cmath>

#include "preview/layer.h"

namespace cloudbake {

/// One sample of a march.
struct CloudSample {
  Vec3 color;         ///< not multiplied by the opacity
  float opacity = 0;  ///< 0 … 1
  float step = 0;     ///< to the next sample, > 0; infinite after the last one
};

/// Samples from front to back: the sample at t() is to be given to take() as long as there are more(). A sample stands for the way to the
/// next one: of a sample of the opacity a, the share f of its way has the opacity 1 − (1 − a)^f.
class SampleSum {
 public:
  SampleSum(float t, int samples, float stop_opacity, const Cuts& cuts = {})
      : t_(t), left_(samples), stop_opacity_(stop_opacity), cuts_(cuts) {}
  bool more() const { return left_ > 0 && all_.opacity <= stop_opacity_ && std::isfinite(t_) && !is_hidden_; }
  float t() const { return t_; }
  void take(const CloudSample& sample) {
    const float end = std::isfinite(sample.step) ? t_ + sample.step : t_;
    float from = t_, opacity = sample.opacity;
    while (part_ < size_t(cuts_.count) && (cuts_.cuts[part_].distance < end || cuts_.cuts[part_].distance <= from)) {
      const float cut = std::max(from, cuts_.cuts[part_].distance), share = end > from ? (cut - from) / (end - from) : 0;
      add(from, sample.color, 1 - std::pow(1 - opacity, share));
      opacity = 1 - std::pow(1 - opacity, 1 - share);
      from = cut;
      closePart();
    }
    if (!is_hidden_) add(from, sample.color, opacity);
    t_ += sample.step;
    --left_;
  }
  CutPixels pixels() {
    if (!is_hidden_) closePart();
    return pixels_;
  }

 private:
  struct Sums {
    Vec3 color;
    float opacity = 0, distance = 0;
  };

  void add(float t, Vec3 color, float opacity) {
    if (!(opacity > 0)) return;
    const float added = (1 - all_.opacity) * opacity;
    all_.color += color * added;
    all_.distance += t * added;
    all_.opacity += added;
  }

  // Whatever was added since the last cut, as it is alone.
  void closePart() {
    const float added = all_.opacity - before_.opacity;
    if (added > 0)
      pixels_[part_] = {(all_.color - before_.color) / added, std::min(added / (1 - before_.opacity), 1.0F),
                        (all_.distance - before_.distance) / added};
    before_ = all_;
    if (part_ < size_t(cuts_.count)) is_hidden_ = cuts_.cuts[part_].is_opaque;
    ++part_;
  }

  Sums all_, before_;  // from the eye to here, and to the last cut
  CutPixels pixels_;
  size_t part_ = 0;
  float t_;
  int left_;
  float stop_opacity_;
  bool is_hidden_ = false;
  Cuts cuts_;
};

}  // namespace cloudbake
