// PLY: G. Turk, "The PLY Polygon File Format" (1994). The header declares elements, each with a number of rows and its properties,
// which are scalars or lists (a length, then values). The rows follow in the same order, as lines of text or packed.
#include "io/sculpt/ply_header.h"

#include <array>
#include <bit>

#include "core/error.h"
#include "core/text/plain_text.h"

namespace cloudbake {

namespace {

struct NamedType {
  std::string_view name;
  PlyType type;
};
constexpr std::array<NamedType, 16> kTypes{{{"char", PlyType::kInt8},
                                            {"int8", PlyType::kInt8},
                                            {"uchar", PlyType::kUint8},
                                            {"uint8", PlyType::kUint8},
                                            {"short", PlyType::kInt16},
                                            {"int16", PlyType::kInt16},
                                            {"ushort", PlyType::kUint16},
                                            {"uint16", PlyType::kUint16},
                                            {"int", PlyType::kInt32},
                                            {"int32", PlyType::kInt32},
                                            {"uint", PlyType::kUint32},
                                            {"uint32", PlyType::kUint32},
                                            {"float", PlyType::kFloat32},
                                            {"float32", PlyType::kFloat32},
                                            {"double", PlyType::kFloat64},
                                            {"float64", PlyType::kFloat64}}};

std::optional<PlyType> typeNamed(std::string_view name) {
  for (const NamedType& known : kTypes)
    if (known.name == name) return known.type;
  return std::nullopt;
}

// The size of a binary scalar in bytes, in order of PlyType.
uint64_t typeBytes(PlyType type) {
  constexpr std::array<uint64_t, 8> kBytes{1, 1, 2, 2, 4, 4, 4, 8};
  return kBytes[size_t(type)];
}

PlyProperty readProperty(const PlyInput& input, std::string_view line) {
  PlyProperty property;
  std::string_view type_name = takeWord(line);
  if (type_name == "list") {
    property.length_type = typeNamed(takeWord(line));
    type_name = takeWord(line);
    if (!property.length_type || typeBytes(*property.length_type) == 8)
      input.fail("the length of a list does not have a whole-number type");
  }
  const auto type = typeNamed(type_name);
  if (!type) input.fail(quotedWord(type_name) + " is not a PLY type");
  property.type = *type;
  property.name = takeWord(line);
  return property;
}

// The bits of a scalar as a whole number.
uint64_t loadBits(std::string_view data, bool little_endian) {
  uint64_t bits = 0;
  for (size_t i = 0; i < data.size(); ++i) bits = bits << 8 | static_cast<unsigned char>(data[little_endian ? data.size() - 1 - i : i]);
  return bits;
}

// Removes one row from the front of `data`. Returns false if the row ends beyond it.
bool takeBinaryRow(const PlyElement& element, bool little_endian, std::string_view& data, std::vector<std::string_view>& cells) {
  for (const PlyProperty& property : element.properties) {
    const uint64_t value_bytes = typeBytes(property.type);
    uint64_t values = 1;
    if (property.length_type) {
      const uint64_t length_bytes = typeBytes(*property.length_type);
      if (data.size() < length_bytes) return false;
      values = loadBits(data.substr(0, length_bytes), little_endian);
      data.remove_prefix(length_bytes);
    }
    if (values > data.size() / value_bytes) return false;
    cells.push_back(data.substr(0, values * value_bytes));
    data.remove_prefix(cells.back().size());
  }
  return true;
}

// The same for a line of text.
bool takeTextRow(const PlyInput& input, const PlyElement& element, std::string_view line, std::vector<std::string_view>& cells) {
  for (const PlyProperty& property : element.properties) {
    const std::string_view word = takeWord(line);
    if (word.empty()) return false;
    cells.push_back(word);
    if (!property.length_type) continue;
    const auto length = parseInteger(word);
    if (!length || *length < 0) input.fail("the length of a list is " + quotedWord(word) + ", which is no count");
    const char* begin = line.data();
    for (long long i = 0; i < *length; ++i)
      if (takeWord(line).empty()) return false;
    cells.back() = trimmed({begin, size_t(line.data() - begin)});
  }
  return true;
}

}  // namespace

void PlyInput::fail(const std::string& what) const {
  throw InputError(file.string(), scanner.line, what + "; the file is damaged or truncated, export it again");
}

std::string_view mendPly(const std::filesystem::path& file, std::string_view bytes, std::string& storage) {
  const std::string_view plain = withoutByteOrderMark(bytes), header = plain.substr(0, plain.find("end_header"));
  return header.find("format binary_") == header.npos ? plainText(bytes, file.string(), storage) : plain;
}

PlyInput openPly(const std::filesystem::path& file, std::string_view mended) {
  const bool old_mac = mended.size() > 4 && mended[3] == '\r' && mended[4] != '\n';
  return {file, {mended, 0, old_mac ? '\r' : '\n'}};
}

PlyHeader readPlyHeader(PlyInput& input) {
  PlyHeader header;
  if (!input.scanner.rest.starts_with("ply")) input.fail("a PLY must begin with 'ply'");
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
    if (key == "comment" && lowerCase(takeWord(rest)) == "texturefile") header.textures.emplace_back(trimmed(rest));
    if (key == "element") {
      const std::string_view name = takeWord(rest);
      const std::string_view count = takeWord(rest);
      const auto rows = parseInteger(count);
      if (!rows || *rows < 0 || *rows > 0xFFFFFFFFLL)
        input.fail("the number of rows of an element is " + quotedWord(count) + ", not a whole number from 0 to 4294967295");
      header.elements.push_back({std::string(name), uint64_t(*rows), {}, input.scanner.line});
    }
    if (key == "property" && header.elements.empty()) input.fail("a property appears before any element");
    if (key == "property") header.elements.back().properties.push_back(readProperty(input, rest));
  }
}

void takePlyRow(PlyInput& input, PlyFormat format, const PlyElement& element, uint64_t row, std::vector<std::string_view>& cells) {
  if (element.properties.empty()) input.fail("an element has rows but no properties");
  cells.clear();
  const auto failEarly = [&] {
    input.fail("the PLY ends after " + std::to_string(row) + " of " + std::to_string(element.rows) + " rows of an element");
  };
  if (format != PlyFormat::kText) {
    if (!takeBinaryRow(element, format == PlyFormat::kLittleEndian, input.scanner.rest, cells)) failEarly();
    return;
  }
  std::optional<std::string_view> line;
  do line = input.scanner.next();
  while (line && line->find_first_not_of(" \t\r") == std::string_view::npos);
  if (!line) failEarly();
  if (!takeTextRow(input, element, *line, cells)) input.fail("a row has fewer values than the header declares");
}

std::optional<float> plyNumber(std::string_view cell, PlyType type, PlyFormat format) {
  if (format == PlyFormat::kText) return parseFloat(cell);
  const uint64_t bits = loadBits(cell, format == PlyFormat::kLittleEndian);
  switch (type) {
    case PlyType::kInt8: return float(int8_t(bits));
    case PlyType::kUint8: return float(uint8_t(bits));
    case PlyType::kInt16: return float(int16_t(bits));
    case PlyType::kUint16: return float(uint16_t(bits));
    case PlyType::kInt32: return float(int32_t(bits));
    case PlyType::kUint32: return float(uint32_t(bits));
    case PlyType::kFloat32: return std::bit_cast<float>(uint32_t(bits));
    case PlyType::kFloat64: return float(std::bit_cast<double>(bits));
  }
  return std::nullopt;
}

std::string_view takePlyValue(std::string_view& cell, PlyType type, PlyFormat format) {
  if (format == PlyFormat::kText) {
    const std::string_view word = takeWord(cell);
    cell = trimmed(cell);
    return word;
  }
  const std::string_view value = cell.substr(0, typeBytes(type));
  cell.remove_prefix(value.size());
  return value;
}

std::optional<long long> plyIndex(std::string_view value, PlyType type, PlyFormat format) {
  if (format == PlyFormat::kText) return parseInteger(value);
  const uint64_t bits = loadBits(value, format == PlyFormat::kLittleEndian);
  switch (type) {
    case PlyType::kInt8: return int8_t(bits);
    case PlyType::kInt16: return int16_t(bits);
    case PlyType::kInt32: return int32_t(bits);
    case PlyType::kUint8:
    case PlyType::kUint16:
    case PlyType::kUint32: return (long long)(bits);
    case PlyType::kFloat32:
    case PlyType::kFloat64: return std::nullopt;
  }
  return std::nullopt;
}

}  // namespace cloudbake
