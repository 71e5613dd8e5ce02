// PLY: G. Turk, "The PLY Polygon File Format" (1994). The header declares elements, each with a number of rows and its properties,
// scalars or lists (a length, then values). assimp takes memory for what is declared before it looks at the data, and reads on in stale
// memory where the data ends early, so every row is walked over first.
#include <array>

#include "core/error.h"
#include "io/read_mesh.h"
#include "io/text_scan.h"

namespace cloudbake {

namespace {

struct PlyProperty {
  uint64_t length_bytes = 0;  // of a list's length; 0: a scalar
  uint64_t value_bytes = 0;
};

struct PlyElement {
  uint64_t rows = 0;
  std::vector<PlyProperty> properties;
};

enum class PlyFormat { kText, kLittleEndian, kBigEndian };

struct PlyHeader {
  PlyFormat format = PlyFormat::kText;
  std::vector<PlyElement> elements;
};

// The file as far as it is read, for messages with a line.
struct PlyInput {
  const std::filesystem::path& file;
  const std::string& bytes;
  LineScanner scanner;
  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(file.string(), scanner.line, what + "; the file is damaged or truncated, export it again");
  }
};

struct Named {
  std::string_view name;
  uint64_t bytes;
};
constexpr std::array<Named, 16> kTypes{{{"char", 1},
                                        {"int8", 1},
                                        {"uchar", 1},
                                        {"uint8", 1},
                                        {"short", 2},
                                        {"int16", 2},
                                        {"ushort", 2},
                                        {"uint16", 2},
                                        {"int", 4},
                                        {"int32", 4},
                                        {"uint", 4},
                                        {"uint32", 4},
                                        {"float", 4},
                                        {"float32", 4},
                                        {"double", 8},
                                        {"float64", 8}}};

// Bytes of a binary scalar; 0 where the name is no type.
uint64_t typeBytes(std::string_view type) {
  for (const Named& known : kTypes)
    if (known.name == type) return known.bytes;
  return 0;
}

PlyProperty readProperty(const PlyInput& input, std::string_view line) {
  PlyProperty property;
  std::string_view type = takeWord(line);
  if (type == "list") {
    property.length_bytes = typeBytes(takeWord(line));
    type = takeWord(line);
    if (property.length_bytes == 0 || property.length_bytes == 8) input.fail("the length of a list has no whole-number type");
  }
  property.value_bytes = typeBytes(type);
  if (property.value_bytes == 0) input.fail("'" + std::string(type.substr(0, 20)) + "' is no type of PLY");
  return property;
}

PlyHeader readHeader(PlyInput& input) {
  PlyHeader header;
  if (!input.bytes.starts_with("ply")) input.fail("a PLY must begin with 'ply'");
  for (;;) {
    const auto line = input.scanner.next();
    if (!line) input.fail("the PLY's header has no end");
    std::string_view rest = *line;
    const std::string_view key = takeWord(rest);
    if (key == "end_header") return header;
    if (key == "format") {
      const std::string_view name = takeWord(rest);
      header.format = name == "binary_little_endian" ? PlyFormat::kLittleEndian
                      : name == "binary_big_endian"  ? PlyFormat::kBigEndian
                                                     : PlyFormat::kText;
    }
    if (key == "element") {
      takeWord(rest);
      const auto rows = parseInteger(takeWord(rest));
      if (!rows || *rows < 0 || *rows > 0xFFFFFFFFLL) input.fail("the number of rows of an element is no number, or too large");
      header.elements.push_back({uint64_t(*rows), {}});
    }
    if (key == "property" && header.elements.empty()) input.fail("a property stands before any element");
    if (key == "property") header.elements.back().properties.push_back(readProperty(input, rest));
  }
}

// The length of a list at the front of `data`.
uint64_t loadLength(std::string_view data, uint64_t bytes, bool little_endian) {
  uint64_t length = 0;
  for (uint64_t i = 0; i < bytes; ++i) length = length << 8 | static_cast<unsigned char>(data[little_endian ? bytes - 1 - i : i]);
  return length;
}

// Takes one row off the front of `data`; false where it ends beyond it.
bool skipRow(const PlyElement& element, bool little_endian, std::string_view& data) {
  for (const PlyProperty& property : element.properties) {
    uint64_t values = 1;
    if (property.length_bytes > 0) {
      if (data.size() < property.length_bytes) return false;
      values = loadLength(data, property.length_bytes, little_endian);
      data.remove_prefix(property.length_bytes);
    }
    if (values > data.size() / property.value_bytes) return false;
    data.remove_prefix(values * property.value_bytes);
  }
  return true;
}

// The same for a line of text.
bool isWholeRow(const PlyElement& element, std::string_view line) {
  for (const PlyProperty& property : element.properties) {
    std::string_view word = takeWord(line);
    if (word.empty()) return false;
    const auto length = property.length_bytes > 0 ? parseInteger(word) : 0;
    if (!length || *length < 0) return false;
    for (long long i = 0; i < *length; ++i)
      if (takeWord(line).empty()) return false;
  }
  return true;
}

void checkText(PlyInput& input, const PlyElement& element) {
  for (uint64_t row = 0; row < element.rows; ++row) {
    std::optional<std::string_view> line;
    do line = input.scanner.next();
    while (line && line->find_first_not_of(" \t\r") == std::string_view::npos);
    if (!line) input.fail("the PLY ends after " + std::to_string(row) + " of " + std::to_string(element.rows) + " rows of an element");
    if (!isWholeRow(element, *line)) input.fail("a row has fewer values than the header says");
  }
}

}  // namespace

void checkPly(const std::filesystem::path& file, const std::string& bytes) {
  PlyInput input{file, bytes, {bytes}};
  const PlyHeader header = readHeader(input);
  std::string_view data = input.scanner.rest;
  for (const PlyElement& element : header.elements) {
    if (element.properties.empty() && element.rows > 0) input.fail("an element has rows but no properties");
    if (header.format == PlyFormat::kText) {
      checkText(input, element);
      continue;
    }
    for (uint64_t row = 0; row < element.rows; ++row)
      if (!skipRow(element, header.format == PlyFormat::kLittleEndian, data))
        input.fail("the PLY ends after " + std::to_string(row) + " of " + std::to_string(element.rows) + " rows of an element");
  }
}

}  // namespace cloudbake
