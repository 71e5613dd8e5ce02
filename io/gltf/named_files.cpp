#include "io/gltf/named_files.h"

#include <charconv>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/text/json.h"
#include "io/gltf/document.h"

namespace cloudbake {

namespace {

// The decoded "uri" of every element of an array of the document. Data URIs and URIs with a scheme are not files and are skipped.
void addUris(const Json& document, const char* array, const std::filesystem::path& folder, std::vector<std::filesystem::path>& named) {
  const auto found = document.find(array);
  if (found == document.end() || !found->is_array()) return;
  for (const Json& element : *found) {
    const auto uri = element.is_object() ? element.find("uri") : element.end();
    if (!element.is_object() || uri == element.end() || !uri->is_string()) continue;
    const std::string& text = uri->get_ref<const std::string&>();
    if (text.empty() || text.starts_with("data:") || text.find("://") != text.npos) continue;
    named.push_back(folder / percentDecoded(text));
  }
}

}  // namespace

std::string percentDecoded(std::string_view uri) {
  std::string text;
  for (size_t i = 0; i < uri.size(); ++i) {
    unsigned code = 0;
    if (uri[i] == '%' && i + 2 < uri.size() && std::from_chars(&uri[i + 1], &uri[i + 3], code, 16).ptr == &uri[i + 3])
      text += char(code), i += 2;
    else
      text += uri[i];
  }
  return text;
}

std::vector<std::filesystem::path> filesNamedByGltf(const std::filesystem::path& file, std::string_view bytes) {
  std::vector<std::filesystem::path> named;
  try {
    const std::optional<Json> document = parseJson(splitGlb(file, bytes).json);
    if (!document || !document->is_object()) return named;
    addUris(*document, "buffers", file.parent_path(), named);
    addUris(*document, "images", file.parent_path(), named);
  } catch (const InputError&) {  // the reader will report it
  }
  return named;
}

std::string_view imageMimeType(std::string_view bytes) {
  using namespace std::string_view_literals;
  if (bytes.starts_with("\x89PNG\r\n\x1A\n"sv)) return "image/png";
  if (bytes.starts_with("\xFF\xD8\xFF"sv)) return "image/jpeg";
  if (bytes.starts_with("\xABKTX 20\xBB"sv)) return "image/ktx2";
  if (bytes.starts_with("RIFF"sv) && bytes.substr(std::min<size_t>(8, bytes.size())).starts_with("WEBP"sv)) return "image/webp";
  if (bytes.starts_with("DDS "sv)) return "image/vnd-ms.dds";
  if (bytes.substr(std::min<size_t>(4, bytes.size())).starts_with("ftypavif"sv)) return "image/avif";
  return "";
}

}  // namespace cloudbake
