// The page has everything in it: settings, vertices and triangles as JSON, the script, and the shaders.
#include "pipeline/page/live_page.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/text/maker.h"
#include "core/text/markup.h"
#include "pipeline/page/viewer_pages.h"
#include "preview/backdrop/glsl_structs.h"

namespace cloudbake {

std::string livePageData(std::span<const LiveScene> scenes) {
  Json page = {{"looks", Json::array()}, {"scenes", Json::array()}};
  for (const LiveScene& one : scenes) {
    Json scene = one.scene;
    for (const auto& [name, look] : one.looks.items()) {  // most scenes have the same looks
      size_t index = 0;
      while (index < page["looks"].size() && page["looks"][index] != look) ++index;
      if (index == page["looks"].size()) page["looks"].push_back(look);
      scene["looks"][name] = index;
    }
    page["scenes"].push_back(std::move(scene));
  }
  return page.dump(-1, ' ', false, Json::error_handler_t::replace);  // a file name may hold any bytes
}

std::string livePage(std::span<const LiveScene> scenes, PageKind kind) {
  const std::string name = scenes.front().scene["name"];
  const bool is_served = kind == PageKind::kServed;
  // A scene file that is watched may get layers.
  const bool may_have_layers =
      is_served || std::any_of(scenes.begin(), scenes.end(), [](const LiveScene& one) { return one.scene.contains("layers"); });
  return filledTemplate(glslWithStructs(viewerPages()[may_have_layers ? 1 : 0].text),
                        {{"@MAKER@", std::string(kMaker)},
                         {"@TITLE@", escapedMarkup(name)},
                         {"@NAME@", escapedMarkup(name)},
                         {"@CONNECT@", is_served ? "'self'" : "'none'"},
                         {"@EVENTS@", is_served ? " data-events=\"yes\"" : ""},
                         {"@PAGE@", filledTemplate(livePageData(scenes), {{"<", "\\u003c"}})}});  // a name must not end the script
}

}  // namespace cloudbake
