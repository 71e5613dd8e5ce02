#include "io/gltf/asset/relabel.h"

#include "core/error.h"
#include "io/gltf/asset_info.h"
#include "io/gltf/document.h"

namespace cloudbake {

std::string relabelled(const std::filesystem::path& file, std::string_view glb, const LevelLabel& label) {
  const GlbChunks chunks = splitGlb(file, glb);
  auto document = parseJson(chunks.json);
  if (!document) throw InputError(file.string(), "its JSON is damaged");
  const bool is_impostor = isImpostorDocument(*document);
  if (!is_impostor) requireInfo(file, *document);
  Json& own = (*document)["asset"]["extras"]["cloudbake"];
  for (const char* key : {"level", "switch_pixels", "level_of"}) own.erase(key);
  if (label.level > 0) {
    own["level"] = label.level, own["switch_pixels"] = label.switch_pixels;
    if (is_impostor) own["level_of"] = label.level_of;
  }
  return joinGlb(file, document->dump(), chunks.binary);
}

}  // namespace cloudbake
