// Lobe impostors of baked assets (`cloudbake impostor`): the atlas, a lit picture for its quad, and how near they come to the volume.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bake/impostor/bake_impostor.h"
#include "core/impostor.h"
#include "io/gltf/asset_info.h"
#include "io/gltf/impostor/impostor_file.h"
#include "io/report/report.h"
#include "pipeline/fields/cloud.h"
#include "pipeline/fields/stopwatch.h"
#include "pipeline/options/settings.h"

namespace cloudbake {

/// What the figures of an atlas say: rms over lights and texels by opacity, against what the texels are to show.
struct ImpostorFigures {
  size_t texels = 0;   ///< in which something is seen
  double fitted = 0;   ///< of the fitted lobes
  double stored = 0;   ///< of the lobes as the atlas stores them
  double six_way = 0;  ///< of six-way maps of the same light, as they are stored
};

/// Six-way light maps in Unity's layout, of the same frames as the atlas: RGBA of right, top, back and opacity, and of left, bottom, front
/// and 0. Light from an axis of the view shows what the map of this axis has.
struct SixWayMaps {
  std::vector<uint8_t> first, second;  ///< 8 bits, rows from the top
  int size = 0;                        ///< pixels to a side
};

struct BakedImpostor {
  Impostor impostor;
  ImpostorFigures figures;
  std::optional<SixWayMaps> six_way;
};

/// A baked asset that impostors are made of.
struct ImpostorSubject {
  BakedMesh mesh;
  Cloud cloud;
  std::string hash;  ///< XXH3-128 of its bytes, hexadecimal
};
/// Reads settings.source.input. Throws as readSculpt and decodeGlb do.
ImpostorSubject readImpostorSubject(const Settings& settings, BakeReport& report, Stopwatch& watch);

/// Throws InputError if the mesh encloses nothing and the volume is asked for, or if nothing of it is seen.
BakedImpostor bakeImpostor(const ImpostorSubject& subject, const Settings& settings, BakeReport& report, Stopwatch& watch);

/// A picture of the impostor from +Z under the default sun, in the painted look's light.
Billboard billboardOf(const Impostor& impostor);

std::string impostorText(const BakedImpostor& baked);
Json impostorJson(const BakedImpostor& baked);

}  // namespace cloudbake
