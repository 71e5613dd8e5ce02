// The difference between two pictures as three figures and a map. Values are compared as they are, so pass pictures as shown (toneMap).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/image.h"

namespace cloudbake {

/// The pixels that count: one byte per pixel, rows from the top, 0 = does not count. With an empty mask all pixels count.
using PixelMask = std::vector<uint8_t>;

/// The pixels where either picture differs from the background by more than `threshold` in a channel. All three must have the same size.
PixelMask cloudMask(const Image& a, const Image& b, const Image& background, float threshold = 1 / 255.0F);

// These take two pictures of one size, and a mask of that size or an empty one; anything else throws std::invalid_argument. If no pixel
// counts, nothing differs: 0, infinity, 1.

/// Root mean square of a − b over the pixels that count and their three channels.
double imageRms(const Image& a, const Image& b, std::span<const uint8_t> mask = {});

/// 20·log₁₀(peak/rms), decibels; infinite for equal pictures. `peak` is white.
float imagePsnr(const Image& a, const Image& b, std::span<const uint8_t> mask = {}, float peak = 1);

/// Structural similarity of the luminances, −1 … 1, 1 for equal pictures: the mean over the pixels that count and whose window of 11 × 11
/// is inside the picture.
double imageSsim(const Image& a, const Image& b, std::span<const uint8_t> mask = {}, float peak = 1);

/// Standard deviation of the luminances over the pixels that count: how much light and shade a picture has. 0 if none counts.
double luminanceSpread(const Image& image, std::span<const uint8_t> mask = {});

/// |a − b| per pixel (the rms of its channels) in display colours: grey where equal, over yellow to red at `full_scale` > 0 and beyond;
/// black where a pixel does not count.
Image errorMap(const Image& a, const Image& b, float full_scale = 0.25F, std::span<const uint8_t> mask = {});

/// The map's colour for an error of `share` of its full scale.
Vec3 errorColor(float share);

}  // namespace cloudbake
