// How right the keys of a sequence are, and what is blended between them.
#pragma once

#include "core/sequence.h"
#include "pipeline/check/report.h"
#include "pipeline/options/settings.h"

namespace cloudbake {

/// The figures of every key, and of the moment halfway to the next one: what a new bake of its mesh gives beside its lobes, at a sample of
/// vertices. In the order of segments and frames. Throws InputError that names the frame for a mesh that bounds nothing.
SequenceFigures measureKeys(const CloudSequence& sequence, const MeshSettings& mesh);

/// Why a sequence fails whose worst key is sound; none if it is sound.
std::optional<AssetFault> judgeKeys(const SequenceFigures& figures);

/// How much T may differ from that of a new bake of a key's mesh, rms. The lobes of a key have seen what --detail removes from its mesh.
inline constexpr double kKeyAgreement = 0.1;

}  // namespace cloudbake
