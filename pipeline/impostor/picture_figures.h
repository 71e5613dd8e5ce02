// How near the pictures of an impostor come to those of the volume: `impostor --measure`.
#pragma once

#include <string>
#include <vector>

#include "io/report/report.h"
#include "pipeline/impostor/impostor.h"

namespace cloudbake {

/// The rms of 8-bit values over the pixels that show the cloud, of all pictures of a size.
struct SizeFigures {
  int pixels = 0;  ///< that the ball of the impostor covers
  /// Against the volume: the impostor, six-way maps in an atlas of the same bytes, and the mesh, opaque and as opaque as the volume.
  double impostor = 0, six_way = 0, mesh = 0, soft_mesh = 0;
  double impostor_to_mesh = 0;                 ///< of the impostor against the opaque mesh
  double next_frame = 0, mesh_next_frame = 0;  ///< how much pictures change from one degree of a turn to the next: impostor, mesh
};

/// Pictures of 60 views with 2 of 24 suns each, in the plain look; the judge is renderVolume (preview/compare/volume.h).
std::vector<SizeFigures> pictureFigures(const ImpostorSubject& subject, const Settings& settings, const BakedImpostor& baked,
                                        BakeReport& report);

std::string pictureFiguresText(const std::vector<SizeFigures>& figures);
Json pictureFiguresJson(const std::vector<SizeFigures>& figures);

}  // namespace cloudbake
