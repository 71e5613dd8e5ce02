#include "pipeline/measure/oracle.h"

#include "bake/lobe/directions.h"
#include "bake/lobe/sweep.h"
#include "bake/truth/error_metrics.h"

namespace cloudbake {

namespace {

constexpr size_t kTruthVertices = 2000, kMarchedTruthVertices = 200;

}  // namespace

Oracle askOracle(const Cloud& cloud, const FieldSettings& settings, std::optional<size_t> vertices, double ray_length,
                 const std::vector<Vec3>& axes) {
  Oracle oracle;
  const size_t wanted = vertices.value_or(truthIsMarched(cloud) ? kMarchedTruthVertices : kTruthVertices);
  oracle.vertices = evenlySpread(cloud.surface.positions.size(), wanted);
  oracle.positions = pick(cloud.surface.positions, oracle.vertices);
  const auto reference = referenceFor(cloud, settings);
  oracle.name = reference->name();
  oracle.truth = trueLobes(*reference, oracle.positions, fibonacciDirections(kTruthDirections), ray_length);
  oracle.axes = axes.empty() ? sweepAxes(kTransmittanceDirections) : axes;
  oracle.lengths = trueLengths(*reference, oracle.positions, bothSenses(oracle.axes), ray_length);
  return oracle;
}

BakeFigures figuresAgainst(const Oracle& oracle, const std::vector<Lobe>& all_lobes, bool is_fit, LobeShape shape, float extinction) {
  const std::vector<Lobe> lobes = pick(all_lobes, oracle.vertices);
  return {oracle.name, lobes.size(), is_fit, compareLobes(lobes, oracle.truth),
          compareTransmittance(lobes, shape, bothSenses(oracle.axes), oracle.lengths, extinction)};
}

}  // namespace cloudbake
