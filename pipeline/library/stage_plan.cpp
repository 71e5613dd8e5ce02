#include "pipeline/library/stage_plan.h"

#include "core/parallel.h"

namespace cloudbake {

StagePlan::StagePlan(std::vector<Stage> stages) : stages_(std::move(stages)) { enter(); }

void StagePlan::enter() {
  LoopProgress* progress = LoopProgress::current();
  if (!progress || now_ == stages_.size()) return;
  double before = 0, all = 0;
  for (size_t i = 0; i < stages_.size(); ++i) all += stages_[i].work, before += i < now_ ? stages_[i].work : 0;
  progress->enter(stages_[now_].name, before / all, (before + stages_[now_].work) / all);
}

// A stage that is not ahead is ignored: a cloud that does not fit its domain grows again.
void StagePlan::end(const std::string& stage) {
  for (size_t i = now_; i < stages_.size(); ++i)
    if (stages_[i].name == stage) {
      now_ = i + 1;
      enter();
      return;
    }
}

StagePlan StagePlan::ofBake(const Settings& settings, bool is_grown) {
  const MeshSettings& mesh = settings.mesh;
  const LobeSettings& lobe = settings.lobe;
  std::vector<Stage> stages;
  const auto add = [&](bool is_there, const char* name, double work) {
    if (is_there) stages.push_back({name, work});
  };
  const bool is_volume = settings.source.kind == SourceKind::kVolume, is_sculpt = !is_grown && !is_volume;
  add(is_grown, "grow", 0.1);
  add(is_grown, "level set", 2);
  add(!is_grown, "read", 0.1);
  add(is_sculpt, "check", 0.1);
  add(is_sculpt && mesh.inspect, "inspect", 1);
  add(is_sculpt && (mesh.repair.orient || mesh.repair.fill), "repair", 1);
  add(!is_sculpt || (mesh.vertices && !mesh.refine), "surface", 0.5);
  add(is_sculpt && (mesh.remesh || mesh.repair_remesh), "surface", 8);
  add(is_sculpt, "check", 0.1);
  add(is_sculpt && mesh.refine, "refine", 4);
  add(lobe.target_error.has_value(), "target", 1);
  const bool is_marched = lobe.bake.method == Method::kRays;
  const double bake = (is_marched ? 0.2 : 0.01) * lobe.bake.rays, fit = lobe.fit ? 2 : 0;
  add(mesh.separate, "objects", 0.2 + bake + fit);  // field, bake and fit of one after the other
  add(!mesh.separate, "field", 0.2);
  add(!mesh.separate, "bake", bake);
  add(!mesh.separate && lobe.fit, "fit", fit);
  add(!mesh.separate && lobe.smooth > 0, "smooth", 0.01 * lobe.smooth);
  add(!mesh.separate && lobe.fit, "fit", 0.2);  // its errors
  add(!mesh.separate && lobe.harmonic_order > 0, "harmonics", 0.02 * lobe.bake.rays);
  add(true, "encode", 0.1);
  return StagePlan(std::move(stages));
}

StagePlan StagePlan::ofCheck(const Settings& settings) {
  if (settings.judge.against) return StagePlan({{"read", 1}, {"compare", 1}});
  return StagePlan({{"read", 1}, {"check", 0.5}, {"truth", 4}});
}

}  // namespace cloudbake
