// How much the light of a packed asset can differ from that of the asset that it was made of: a bound, not an estimate.
#pragma once

#include <span>

#include "core/lobe_packing.h"
#include "core/sculpt.h"
#include "core/types.h"

namespace cloudbake {

/// A step of 8-bit colour: the most that packing may change T.
inline constexpr double kMostPackedError = 1.0 / 255;

/// The lobes of a part as a packed asset stores them: dequantisedLobe's argument.
struct PackedPart {
  const SculptPart& part;
  std::span<const LobeUvs> stored;  ///< #V
};

/// The range of σ that a certificate is for: that of the fit, else from half to twice the asset's σ.
PackingCertificate certificateRange(const AssetInfo& info);

/// An upper bound of |T − T'| over all vertices of the parts, all lights, all σ in the range, and all lobes (o, d) whose nearest integers
/// are those stored; T' is of the stored lobe. Found from the integers alone. The bound is rounded up to three digits. `info` has k, b and
/// density_max. docs/lobe_math.md has the derivation.
PackingCertificate certify(std::span<const PackedPart> parts, const AssetInfo& info, const PackingCertificate& range);

}  // namespace cloudbake
