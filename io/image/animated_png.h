// Encodes animated PNGs (Mozilla's APNG), which browsers play, frame by frame: of all frames only two are in memory.
#pragma once

#include <cstdint>
#include <functional>
#include <string_view>
#include <vector>

#include "core/image.h"

namespace cloudbake {

/// An animated PNG that loops forever. The same frames give the same bytes.
class AnimatedPng {
 public:
  /// For this many frames of one size, at least one; `write` receives the bytes in order. `frames_per_second` is at most 655.
  AnimatedPng(size_t frames, double frames_per_second, std::function<void(std::string_view)> write);
  /// The next frame, with values as encodePng wants them. Throws std::invalid_argument for another size than that of the first one, and for
  /// more frames than were announced.
  void add(const Image& tone_mapped_srgb);
  /// After the last frame. Throws std::logic_error if frames are missing.
  void end();

 private:
  void begin(const Image& first);

  const size_t frames_;
  const uint16_t delay_denominator_;
  const std::function<void(std::string_view)> write_;
  int width_ = 0, height_ = 0;
  size_t added_ = 0;
  uint32_t sequence_ = 0;
  std::vector<uint8_t> before_;  // the RGB bytes of the previous frame
};

}  // namespace cloudbake
