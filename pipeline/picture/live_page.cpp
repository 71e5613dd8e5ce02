// Everything is in the page: settings, vertices and triangles as JSON, the script, and the shaders.
#include "pipeline/picture/live_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/text/maker.h"
#include "core/text/markup.h"
#include "pipeline/picture/viewer_files.h"

namespace cloudbake {

namespace {

std::string script(const std::string& attributes, std::string_view text) {
  return fmt::format("<script{}>{}</script>\n", attributes, text);
}

}  // namespace

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
  std::string_view html, code;
  std::string scripts;
  const std::string data = filledTemplate(livePageData(scenes), {{"<", "\\u003c"}});  // a name must not end the script
  const bool has_layers = std::any_of(scenes.begin(), scenes.end(), [](const LiveScene& one) { return one.scene.contains("layers"); });
  const std::string events = kind == PageKind::kServed ? " data-events=\"yes\"" : "";
  scripts += script(events + " type=\"application/json\" id=\"page\"", data);
  const auto addFiles = [&](std::span<const ViewerFile> files) {
    for (const ViewerFile& file : files) {
      const std::string file_name = file.name;
      if (file_name == "page.html") {
        html = file.text;
      } else if (file_name.ends_with(".js")) {
        code = file.text;
      } else {
        scripts += script(" type=\"x-shader/x-fragment\" id=\"shader " + file_name + "\"", file.text);
      }
    }
  };
  addFiles(viewerFiles());
  // A scene file that is watched may get layers.
  if (has_layers || kind == PageKind::kServed) addFiles(viewerLayerFiles());
  scripts += script(" type=\"module\"", code);
  return filledTemplate(html, {{"@MAKER@", std::string(kMaker)},
                               {"@TITLE@", escapedMarkup(name)},
                               {"@NAME@", escapedMarkup(name)},
                               {"@SCRIPT_SOURCES@", "'unsafe-inline'"},
                               {"@CONNECT@", kind == PageKind::kServed ? "'self'" : "'none'"},
                               {"@STYLE@", ""},
                               {"@PANEL@", ""},
                               {"@SCRIPTS@", std::move(scripts)}});
}

}  // namespace cloudbake
