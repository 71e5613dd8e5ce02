// glTF 2.0, section 3.6.1: buffers, GLB-stored ones, and the media types of data URIs (RFC 2397). Names of files are those of RFC 3986:
// only percent-encoding is decoded.
#include "io/gltf/sculpt/buffers.h"

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/memory_budget.h"
#include "core/text/base64.h"
#include "core/text/numbers.h"
#include "core/text/scan.h"
#include "io/file/neighbour.h"
#include "io/gltf/named_files.h"
#include "io/gltf/value_types.h"

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

// A buffer whose bytes are all made by decoding others has no bytes of its own.
bool isFallback(const Json& buffer) {
  if (buffer.contains("uri") || !buffer.contains("extensions")) return false;
  for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"})
    if (buffer["extensions"].contains(name)) return true;
  return false;
}

struct BufferLoader {
  const fs::path& file;
  size_t index;

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(file.string(), "buffer " + std::to_string(index) + " " + what + "; export the file again");
  }

  // "data:" MEDIA-TYPE *(";" PARAMETER) ";base64," DATA
  std::string fromDataUri(std::string_view uri) const {
    const size_t comma = uri.find(',');
    if (comma == uri.npos) fail("is a data URI without a comma");
    const std::string head = lowerCase(uri.substr(5, comma - 5));
    const std::string type = head.substr(0, head.find(';'));
    if (type != "application/octet-stream" && type != "application/gltf-buffer")
      fail("is a data URI of the media type " + valueText(type) + ", not application/octet-stream or application/gltf-buffer");
    if (!head.ends_with(";base64")) fail("is a data URI that is not in base64");
    const std::string_view data = uri.substr(comma + 1);
    std::optional<std::string> bytes = data.find('%') == data.npos ? decodeBase64(data) : decodeBase64(percentDecoded(data));
    if (!bytes) fail("is a data URI with damaged base64");
    return std::move(*bytes);
  }

  std::vector<unsigned char> load(const Json& buffer, std::string_view binary, const ReadSettings& settings) const {
    const size_t length = buffer.at("byteLength").get<size_t>();
    const std::string uri = buffer.value("uri", "");
    if (length == 0) fail("has a byteLength of 0");
    std::string own;
    std::string_view bytes = binary;
    if (uri.starts_with("data:")) {
      bytes = own = fromDataUri(uri);
    } else if (uri.find("://") != uri.npos) {
      fail("is at " + valueText(uri) + ", which is not a file beside the glTF");
    } else if (!uri.empty()) {
      bytes = own = readNeighbour(file, file.parent_path() / percentDecoded(uri), settings);
    } else if (index > 0 || binary.empty()) {
      fail("has no uri");
    }
    if (bytes.size() < length)
      fail((uri.empty()                ? "(the binary chunk)"
            : uri.starts_with("data:") ? "(a data URI)"
                                       : "(" + valueText(uri) + ")") +
           std::string(" has ") + std::to_string(bytes.size()) + " bytes, not its byteLength of " + std::to_string(length));
    return {bytes.begin(), bytes.begin() + ptrdiff_t(length)};
  }
};

}  // namespace

GltfBuffers loadBuffers(const fs::path& file, const Json& json, std::string_view binary, const ReadSettings& settings) {
  const Json none = Json::array();
  const Json& all = json.contains("buffers") ? json["buffers"] : none;
  const auto isEmpty = [&](size_t i) { return (i > 0 || binary.empty()) && isFallback(all[i]); };
  double total = 0;
  int own = 0;  // buffers with bytes of their own
  for (size_t i = 0; i < all.size(); ++i)
    if (!isEmpty(i)) ++own, total += all[i].at("byteLength").get<double>();
  if (own > 1)
    requireMemory({"the " + shortestText(total) + " bytes that its buffers declare", total, "split the file"}, settings.memory_limit,
                  file.string());
  GltfBuffers buffers;
  for (size_t i = 0; i < all.size(); ++i)
    buffers.push_back(isEmpty(i) ? std::vector<unsigned char>() : BufferLoader{file, i}.load(all[i], binary, settings));
  return buffers;
}

}  // namespace cloudbake
