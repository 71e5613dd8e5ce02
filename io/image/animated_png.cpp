// Sources: "APNG Specification" (wiki.mozilla.org/APNG_Specification, now section 11.3.6 of PNG's third edition); PNG, section 12.8: the
// filter of a row is the one whose bytes, as signed numbers, have the least sum of magnitudes.
//
// A frame is the rectangle of the pixels that changed. It is stored in two ways, of which the smaller one is kept: as it is, or with
// transparent pixels where nothing changed. A transparent pixel needs an alpha channel; a colour that means "transparent" cannot be used,
// because a later frame may show that colour.
#include "io/image/animated_png.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "core/parallel.h"
#include "io/file/deflate.h"
#include "io/image/image.h"
#include "io/image/png_chunk.h"

namespace cloudbake {

namespace {

constexpr int kChannels = 4;
constexpr uint8_t kReplace = 0, kOver = 1;  // how a frame is put over the previous one

struct Rectangle {
  int left = 0, top = 0, right = 0, bottom = 0;  // right and bottom are beyond it
  int width() const { return right - left; }
  int height() const { return bottom - top; }
};

bool sameColour(const uint8_t* a, const uint8_t* b) { return std::equal(a, a + 3, b); }

// The rectangle of all pixels that differ; the first pixel if none does, because a frame has at least one.
Rectangle changedPart(const std::vector<uint8_t>& now, const std::vector<uint8_t>& before, int width, int height) {
  Rectangle part{width, height, 0, 0};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const size_t at = 3 * (size_t(y) * size_t(width) + size_t(x));
      if (sameColour(&now[at], &before[at])) continue;
      part = {std::min(part.left, x), std::min(part.top, y), std::max(part.right, x + 1), y + 1};
    }
  return part.right > 0 ? part : Rectangle{0, 0, 1, 1};
}

// The RGBA rows of a part. With `before`, what it has already is transparent.
std::vector<uint8_t> partOf(const std::vector<uint8_t>& rgb, const std::vector<uint8_t>* before, int width, const Rectangle& part) {
  std::vector<uint8_t> bytes;
  bytes.reserve(kChannels * size_t(part.width()) * size_t(part.height()));
  for (int y = part.top; y < part.bottom; ++y)
    for (int x = part.left; x < part.right; ++x) {
      const size_t at = 3 * (size_t(y) * size_t(width) + size_t(x));
      if (before && sameColour(&rgb[at], &(*before)[at]))
        bytes.insert(bytes.end(), {0, 0, 0, 0});
      else
        bytes.insert(bytes.end(), {rgb[at], rgb[at + 1], rgb[at + 2], 255});
    }
  return bytes;
}

int paeth(int left, int above, int corner) {
  const int estimate = left + above - corner;
  const int to_left = std::abs(estimate - left), to_above = std::abs(estimate - above), to_corner = std::abs(estimate - corner);
  return to_left <= to_above && to_left <= to_corner ? left : to_above <= to_corner ? above : corner;
}

// Appends a row, filtered by the best of PNG's five filters.
void appendFiltered(const uint8_t* row, const uint8_t* above, size_t size, std::string& bytes) {
  std::array<std::string, 5> filtered;
  std::array<uint64_t, 5> sums{};
  for (std::string& one : filtered) one.resize(size);
  for (size_t i = 0; i < size; ++i) {
    const int a = i >= kChannels ? row[i - kChannels] : 0, b = above[i], c = i >= kChannels ? above[i - kChannels] : 0;
    const std::array<int, 5> guesses{0, a, b, (a + b) / 2, paeth(a, b, c)};
    for (size_t kind = 0; kind < guesses.size(); ++kind) {
      const auto difference = int8_t(row[i] - guesses[kind]);
      filtered[kind][i] = char(difference);
      sums[kind] += uint64_t(std::abs(int(difference)));
    }
  }
  const size_t best = size_t(std::min_element(sums.begin(), sums.end()) - sums.begin());
  bytes += char(best);
  bytes += filtered[best];
}

std::string packed(const std::vector<uint8_t>& rgba, const Rectangle& part) {
  const size_t row = kChannels * size_t(part.width());
  const std::vector<uint8_t> nothing(row);
  std::string bytes;
  bytes.reserve((row + 1) * size_t(part.height()));
  for (size_t y = 0; y < size_t(part.height()); ++y)
    appendFiltered(&rgba[y * row], y > 0 ? &rgba[(y - 1) * row] : nothing.data(), row, bytes);
  return deflated(bytes, kSmallest);
}

}  // namespace

AnimatedPng::AnimatedPng(size_t frames, double frames_per_second, std::function<void(std::string_view)> write)
    : frames_(frames), delay_denominator_(uint16_t(std::lround(100 * frames_per_second))), write_(std::move(write)) {}

void AnimatedPng::begin(const Image& first) {
  width_ = first.width;
  height_ = first.height;
  write_("\x89PNG\r\n\x1a\n");
  std::string header, animation;
  appendBigEndian(header, uint32_t(width_));
  appendBigEndian(header, uint32_t(height_));
  header += {8, 6, 0, 0, 0};  // bits, RGBA, deflate, the five filters, not interlaced
  write_(pngChunk("IHDR", header));
  appendBigEndian(animation, uint32_t(frames_));
  appendBigEndian(animation, 0);  // repeated for ever
  write_(pngChunk("acTL", animation));
}

void AnimatedPng::add(const Image& image) {
  if (added_ == 0) begin(image);
  if (image.width != width_ || image.height != height_) throw std::invalid_argument("AnimatedPng: frames of different sizes");
  if (added_ == frames_) throw std::invalid_argument("AnimatedPng: more frames than were announced");
  std::vector<uint8_t> rgb = rgbBytes(image);
  const bool is_first = added_++ == 0;
  const Rectangle part = is_first ? Rectangle{0, 0, width_, height_} : changedPart(rgb, before_, width_, height_);
  std::array<std::string, 2> ways;  // by kReplace and kOver
  parallelFor(is_first ? 1 : 2,
              [&](size_t way) { ways[way] = packed(partOf(rgb, way == kOver ? &before_ : nullptr, width_, part), part); });
  const bool is_over = !is_first && ways[kOver].size() < ways[kReplace].size();
  before_ = std::move(rgb);

  std::string control;
  appendBigEndian(control, sequence_++);
  for (const int number : {part.width(), part.height(), part.left, part.top}) appendBigEndian(control, uint32_t(number));
  appendBigEndian(control, 100, 2);  // shown for 100/denominator seconds
  appendBigEndian(control, delay_denominator_, 2);
  control += {0, char(is_over ? kOver : kReplace)};  // it stays where the next frame puts nothing
  write_(pngChunk("fcTL", control));
  if (is_first) return write_(pngChunk("IDAT", ways[kReplace]));
  std::string data;
  appendBigEndian(data, sequence_++);
  write_(pngChunk("fdAT", data + ways[is_over ? kOver : kReplace]));
}

void AnimatedPng::end() {
  if (added_ != frames_) throw std::logic_error("AnimatedPng: frames are missing");
  write_(pngChunk("IEND", {}));
}

}  // namespace cloudbake
