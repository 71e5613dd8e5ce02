#include "pipeline/check/certificate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bake/lobe/directions.h"
#include "core/certificate.h"
#include "core/error.h"
#include "core/lobe_lighting.h"
#include "core/parallel.h"
#include "io/file/write_file.h"
#include "io/gltf/asset/decode.h"
#include "pipeline/check/against.h"
#include "pipeline/fields/stopwatch.h"

namespace cloudbake {

namespace {

constexpr int kLightsOfCertificate = 512;
constexpr int kExtinctions = 5;
constexpr double kReach = 3e-4;  // of the diagonal: half a step of the coarsest grid, along all axes

struct StoredNumbers {
  std::vector<std::vector<LobeUvs>> of_parts;
  bool are_whole = true;  // all numbers are whole steps: centres of cells
};

bool isWhole(float value, double steps) { return std::fabs(value * steps - std::round(value * steps)) < 1e-2; }

StoredNumbers numbersOf(const StoredAsset& asset, int first) {
  StoredNumbers numbers;
  for (const auto& sets : asset.sets) {
    auto& own = numbers.of_parts.emplace_back();
    if (!sets.contains(first) || !sets.contains(first + 1)) continue;
    const StoredUvSet &a = sets.at(first), &b = sets.at(first + 1);
    for (size_t v = 0; v < a.values.size(); ++v) {
      own.push_back({a.values[v], b.values[v]});
      numbers.are_whole = numbers.are_whole && isWhole(a.values[v].x, kDirectionSteps) && isWhole(a.values[v].y, kDirectionSteps) &&
                          isWhole(b.values[v].y, kDensitySteps);
    }
  }
  return numbers;
}

// The largest difference of T between vertices at the same places, over lights and the range of σ.
void measureAgainst(const std::filesystem::path& file, const std::filesystem::path& before_file, const ReadSettings& read,
                    CertificateFigures& figures, Warnings& warnings) {
  const BakedMesh asset = decodeGlb(file, readFileBytes(file), warnings, read);
  const BakedMesh before = decodeGlb(before_file, readFileBytes(before_file), warnings, read);
  const std::vector<uint32_t> matches = matchVertices(asset.surface, before.surface, kReach);
  const std::vector<Vec3> lights = fibonacciDirections(kLightsOfCertificate);
  std::vector<double> most(matches.size());
  parallelFor(matches.size(), [&](size_t v) {
    if (matches[v] == kUnmatched) return;
    const Lobe &now = asset.lobes[v], &then = before.lobes[matches[v]];
    for (const Vec3& light : lights) {
      const double s = lobeThickness(now, light, asset.info.shape), s_before = lobeThickness(then, light, asset.info.shape);
      for (int i = 0; i < kExtinctions; ++i) {
        const double share = double(i) / (kExtinctions - 1),
                     extinction = figures.recorded.extinction_low * (1 - share) + figures.recorded.extinction_high * share;
        most[v] = std::max(most[v], std::fabs(portableExp(-extinction * s) - portableExp(-extinction * s_before)));
      }
    }
  });
  figures.matched = uint64_t(std::count_if(matches.begin(), matches.end(), [](uint32_t match) { return match != kUnmatched; }));
  figures.largest = most.empty() ? 0 : *std::max_element(most.begin(), most.end());
}

std::optional<AssetFault> judgeCertificate(const CertificateFigures& figures) {
  const double most = figures.recorded.transmittance, found = figures.proved.transmittance;
  const char* const pack = "pack the asset again: bake it with --pack 8";
  if (found > most)
    return AssetFault{"certificate", fmt::format("the certificate does not hold: T may change by {:.3g}, and it says {:.3g}", found, most),
                      pack};
  if (found > kMostPackedError)
    return AssetFault{"certificate", fmt::format("T may change by {:.3g}, more than 1/255", found), "bake it without --pack"};
  if (figures.largest && figures.matched == 0)
    return AssetFault{"moved-mesh", "no vertex is where it was before", "compare with the asset that was packed"};
  if (figures.largest && *figures.largest > found)
    return AssetFault{"certificate",
                      fmt::format("T differs by {:.3g} from the other asset, more than the bound {:.3g}", *figures.largest, found),
                      "compare with the asset that was packed, or pack it again"};
  return std::nullopt;
}

}  // namespace

CheckReport checkCertificate(const Settings& settings, const std::function<void(const std::string&)>& on_stage) {
  const std::filesystem::path& file = settings.source.input;
  CheckReport report;
  report.run.command = "check";
  report.run.input = file.string();
  Stopwatch watch(on_stage);
  const StoredAsset stored = readStoredAsset(file, readFileBytes(file), report.run.warnings, settings.source.read);
  report.file = examineAsset(file, stored);
  if (stored.info) report.run.info = *stored.info;
  for (const SculptPart& part : stored.sculpt.parts)
    report.run.vertices += part.positions.size(), report.run.triangles += part.triangles.size();
  watch.lap(report.run.seconds, "read");
  if (report.file.fatal || !report.file.faults.empty()) {
    report.verdict = report.file.fatal ? *report.file.fatal : report.file.faults.front();
    return report;
  }
  const AssetInfo& info = report.run.info;
  if (!(info.density_max > 0) || !info.certificate) {
    report.verdict = AssetFault{"no-certificate", info.density_max > 0 ? "a packed asset without a certificate" : "the asset is not packed",
                                "bake it with --pack 8"};
    return report;
  }
  const StoredNumbers numbers = numbersOf(stored, info.first_uv_set);
  if (!numbers.are_whole) {
    report.verdict = AssetFault{"certificate", "the lobes are not the integers of a packed asset: a program has changed them",
                                "pack the asset as the last step: bake it with --pack 8"};
    return report;
  }
  std::vector<PackedPart> parts;
  for (size_t i = 0; i < numbers.of_parts.size(); ++i) parts.push_back({stored.sculpt.parts[i], numbers.of_parts[i]});
  CertificateFigures& figures = report.certificate.emplace();
  figures.recorded = *info.certificate;
  figures.proved = certify(parts, info, figures.recorded);
  watch.lap(report.run.seconds, "certificate");
  if (settings.judge.against) measureAgainst(file, *settings.judge.against, settings.source.read, figures, report.run.warnings);
  report.verdict = judgeCertificate(figures);
  return report;
}

}  // namespace cloudbake
