// How far one picture is from another: three figures and a map. Values count as they are, so hand in what is shown (toneMap).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/image.h"

namespace cloudbake {

/// Which pixels count: one byte per pixel, rows from the top, 0 = does not. An empty mask: all count.
using PixelMask = std::vector<uint8_t>;

/// The pixels where either picture shows something else than the background: a channel that differs by more than `threshold`. All three of
/// one size.
PixelMask cloudMask(const Image& a, const Image& b, const Image& background, float threshold = 1 / 255.0F);

// Two pictures of one size and a mask of that size or none; anything else throws std::invalid_argument. Where no pixel counts, nothing
// differs: 0, infinity, 1.

/// Root mean square of a − b over the pixels that count and their three channels.
double imageRms(const Image& a, const Image& b, std::span<const uint8_t> mask = {});

/// 20·log₁₀(peak/rms), decibels; infinite for equal pictures. `peak` is white.
float imagePsnr(const Image& a, const Image& b, std::span<const uint8_t> mask = {}, float peak = 1);

/// Structural similarity of the luminances, −1 … 1, 1 for equal pictures: the mean over the pixels that count and whose window of 11 × 11
/// lies in the picture.
double imageSsim(const Image& a, const Image& b, std::span<const uint8_t> mask = {}, float peak = 1);

/// |a − b| per pixel (the rms of its channels) in display colours: grey where equal, over yellow to red at `full_scale` > 0 and beyond;
/// black where a pixel does not count.
Image errorMap(const Image& a, const Image& b, float full_scale = 0.25F, std::span<const uint8_t> mask = {});

/// The map's colour of an error of `share` of its full scale.
Vec3 errorColor(float share);

}  // namespace cloudbake
