// Two values that every option takes, neither of them its default.
#pragma once

#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/options.h"

namespace cloudbake {

struct Samples {
  const char *one = "", *other = "";
};

/// A name in the table for two options, such as --size, has a row for `preview` as NAME@preview.
inline const std::map<std::string, Samples>& optionSamples() {
  static const std::map<std::string, Samples> samples{
      {"as-published", {"true", "false"}},
      {"method", {"rays", "sweep"}},
      {"field", {"levelset", "coverage"}},
      {"rays", {"36", "64"}},
      {"sampler", {"uniform", "fibonacci"}},
      {"fixed-directions", {"true", "false"}},
      {"quadrature", {"end", "midpoint"}},
      {"steps", {"50", "70"}},
      {"ray-length", {"2.5", "3"}},
      {"voxels", {"24", "32"}},
      {"voxel-size", {"0.25", "0.5"}},
      {"bake-voxels", {"30", "40"}},
      {"target-error", {"2", "1%"}},
      {"scene", {"view.toml", "other.toml"}},
      {"lobe", {"fit", "mean"}},
      {"fit-to", {"volume", "transmittance"}},
      {"view-extinction", {"2", "0.5"}},
      {"octaves", {"3", "5,0.6,0.4"}},
      {"phase", {"0.3", "-0.2"}},
      {"exponent", {"2", "fit"}},
      {"bias", {"-1%", "-0.02"}},
      {"extinction", {"2:9", "3"}},
      {"sun-arc", {"5:60,80:100", "30,90"}},
      {"basis", {"sh1", "sh2"}},
      {"lattice", {"a.json", "b.json"}},
      {"lattice-cells", {"8", "12"}},
      {"smooth", {"2", "3"}},
      {"seed", {"7", "18446744073709551615"}},
      {"vertices", {"500", "600"}},
      {"lods", {"50%,25%", "900,300,100"}},
      {"remesh", {"2%", "0.1"}},
      {"refine", {"0.05", "auto"}},
      {"repair", {"orient,fill", "remesh"}},
      {"close", {"wrap", "reject"}},
      {"separate", {"true", "false"}},
      {"inspect", {"true", "false"}},
      {"allow-outside", {"true", "false"}},
      {"scene-index", {"1", "2"}},
      {"uv-set", {"2", "3"}},
      {"attribute", {"true", "false"}},
      {"keep-alive-texture", {"off", "force"}},
      {"blend", {"1%", "0.2"}},
      {"flat-base", {"0", "-1.5"}},
      {"noise", {"3%", "0.1"}},
      {"noise-size", {"20%", "0.7"}},
      {"noise-octaves", {"1", "2"}},
      {"from-spheres", {"a.csv", "b.ply"}},
      {"spheres", {"a.csv", "b.ply"}},
      {"vdb", {"a.vdb", "b.VDB"}},
      {"explain", {"true", "false"}},
      {"dry-run", {"true", "false"}},
      {"rules", {"a.txt", "b.txt"}},
      {"premise", {"F", "FF"}},
      {"generations", {"3", "2.5"}},
      {"variable", {"b=2", "c=0.5"}},
      {"context-ignore", {"+-", "F"}},
      {"context-includes-siblings", {"true", "false"}},
      {"max-modules", {"1000", "2000"}},
      {"max-passes", {"10", "20"}},
      {"max-steps", {"1000", "2000"}},
      {"max-depth", {"10", "20"}},
      {"max-points", {"1000", "2000"}},
      {"max-spheres", {"1000", "2000"}},
      {"step", {"0.5", "0.7"}},
      {"step-scale", {"0.5", "0.7"}},
      {"angle", {"30", "40"}},
      {"angle-scale", {"0.5", "0.6"}},
      {"thickness", {"0.5", "0.7"}},
      {"thickness-scale", {"0.5", "0.7"}},
      {"gravity", {"3", "4"}},
      {"random-scale", {"0.1", "0.2"}},
      {"random-scale-all", {"true", "false"}},
      {"segments", {"2", "3"}},
      {"continuous-length", {"false", "true"}},
      {"continuous-angles", {"false", "true"}},
      {"continuous-width", {"false", "true"}},
      {"pitch-up", {"true", "false"}},
      {"uv-increment", {"0.5", "0.7"}},
      {"vertical-increment", {"0.5", "0.7"}},
      {"start-position", {"1,2,3", "3,2,1"}},
      {"start-rotation", {"10,20,30", "30,20,10"}},
      {"emit", {"points", "leaves"}},
      {"size", {"0.5", "0.7"}},
      {"size@preview", {"640x360", "64x48"}},
      {"leaf-size", {"0.5", "0.7"}},
      {"width-power", {"0.5", "0.7"}},
      {"generation-power", {"0.5", "0.7"}},
      {"radius-min", {"0.5", "0.7"}},
      {"radius-max", {"1.5", "1.7"}},
      {"top-falloff", {"0.5", "0.7"}},
      {"jitter", {"0.5", "0.7"}},
      {"base", {"0", "none"}},
      {"squash", {"0.5", "0.7"}},
      {"ceiling", {"4", "none"}},
      {"flat", {"0.5", "none"}},
      {"count", {"20", "none"}},
      {"domain", {"4x2x4", "none"}},
      {"connect", {"true", "false"}},
      {"units", {"0.01", "2"}},
      {"up", {"z", "x"}},
      {"grid", {"density", "surface"}},
      {"iso", {"0.5", "0.7"}},
      {"truth-vertices", {"50", "70"}},
      {"sun", {"10,20", "20,10"}},
      {"camera", {"10,20", "20,10"}},
      {"fov", {"50", "60"}},
      {"look", {"plain", "painted"}},
      {"time", {"2", "3"}},
      {"channels", {"c", "c.exr"}},
      {"steps@preview", {"s", "t"}},
      {"scene@preview", {"view.toml", "other.toml"}},
      {"quality", {"draft", "final"}},
      {"lobes-only", {"true", "false"}},
      {"turntable", {"8", "9"}},
      {"sun-sweep", {"8", "9"}},
      {"animate", {"8", "9"}},
      {"fps", {"24", "30"}},
      {"frames", {"f", "g"}},
      {"compare", {"true", "false"}},
      {"suns", {"4", "5"}},
      {"view-extinction@preview", {"2", "0.5"}},
      {"octaves@preview", {"3", "5,0.6,0.4"}},
      {"phase@preview", {"0.3", "-0.2"}},
      {"exposure", {"2", "0.5"}},
      {"serve", {"8000", "0"}},
      {"watch", {"a.obj", "b.obj"}},
      {"input-list", {"list.txt", "-"}},
      {"name", {"{stem}.glb", "{stem}_{ext}.glb"}},
      {"init", {"true", "false"}},
      {"memory", {"8G", "500M"}},
      {"force", {"true", "false"}},
      {"prune", {"true", "false"}},
      {"fail-fast", {"true", "false"}},
      {"cache", {"kept", "other"}},
      {"shard", {"2/3", "1/3"}},
      {"merge", {"true", "false"}},
      {"max-angle", {"2", "3"}},
      {"max-transmittance-rms", {"0.1", "0.2"}},
      {"max-surface-rms", {"0.1", "0.2"}},
      {"against", {"a.glb", "b.glb"}},
      {"with-lattice", {"a.json", "b.json"}},
      {"junit", {"a.xml", "b.xml"}},
      {"html", {"a.html", "b.html"}},
      {"live", {"true", "false"}},
      {"depfile", {"a.d", "b.d"}},
      {"depfile-target", {"a", "b"}},
      {"threads", {"2", "3"}},
      {"strict", {"true", "false"}},
      {"json", {"a.json", "b.json"}},
  };
  return samples;
}

/// The row of an option; null where it has none.
inline const Samples* samplesOf(const Option& option) {
  const auto& all = optionSamples();
  auto found = option.commands == kPreview || option.commands == kView ? all.find(std::string(option.name) + "@preview") : all.end();
  if (found == all.end()) found = all.find(option.name);
  return found == all.end() ? nullptr : &found->second;
}

/// The value with another last digit in each of its numbers, one at a time: "5:60" gives "6:60" and "5:61". A single number gives none.
inline std::vector<std::string> withOneNumberChanged(const std::string& value) {
  constexpr const char* kDigits = "0123456789.";
  std::vector<std::string> changed;
  for (size_t begin = value.find_first_of(kDigits); begin != value.npos;) {
    const size_t end = std::min(value.find_first_not_of(kDigits, begin), value.size());
    char& last = changed.emplace_back(value)[end - 1];
    last = last == '9' ? '8' : char(last + 1);
    begin = value.find_first_of(kDigits, end);
  }
  if (changed.size() < 2) changed.clear();
  return changed;
}

}  // namespace cloudbake
