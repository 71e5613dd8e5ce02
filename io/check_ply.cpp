// PLY: G. Turk, "The PLY Polygon File Format" (1994). The header declares elements, each with a count and its properties;
// assimp takes memory for them before it looks at the data, so the counts are held against the file's size first.
#include <array>

#include "core/error.h"
#include "io/read_mesh.h"
#include "io/text_scan.h"

namespace cloudbake {

namespace {

// Bytes of a binary scalar; 0 where the name is no type.
uint64_t typeBytes(std::string_view type) {
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
  for (const Named& known : kTypes)
    if (known.name == type) return known.bytes;
  return 0;
}

}  // namespace

void checkPlyHeader(const std::filesystem::path& file, const std::string& bytes) {
  LineScanner scanner{bytes};
  const auto fail = [&](const std::string& what) {
    throw InputError(file.string(), scanner.line, what + "; the file is damaged, export it again");
  };
  if (!bytes.starts_with("ply")) fail("a PLY must begin with 'ply'");

  bool text = false;
  uint64_t count = 0, row_bytes = 0, needed = 0;
  const auto closeElement = [&] {
    if (count > 0 && row_bytes > bytes.size() / count)
      fail("the PLY claims an element of " + std::to_string(count) + " rows in a file of " + std::to_string(bytes.size()) + " bytes");
    needed += count * row_bytes;
    count = row_bytes = 0;
  };
  for (;;) {
    const auto line = scanner.next();
    if (!line) fail("the PLY's header has no end");
    std::string_view rest = *line;
    const std::string_view key = takeWord(rest);
    if (key == "end_header") break;
    if (key == "format") text = takeWord(rest) == "ascii";
    if (key == "element") {
      closeElement();
      takeWord(rest);
      const auto rows = parseInteger(takeWord(rest));
      if (!rows || *rows < 0 || *rows > 0xFFFFFFFFLL) fail("the number of rows of an element is no number, or too large");
      count = uint64_t(*rows);
    }
    if (key == "property") {
      std::string_view type = takeWord(rest);
      if (type == "list") type = takeWord(rest);  // at least its length is there
      if (typeBytes(type) == 0) fail("'" + std::string(type.substr(0, 20)) + "' is no type of PLY");
      row_bytes += text ? 2 : typeBytes(type);
    }
  }
  closeElement();
  // The last line of a text needs no line end.
  const uint64_t left = scanner.rest.size() + (text ? 1 : 0);
  if (needed > left) fail("the PLY needs at least " + std::to_string(needed) + " bytes of data but has " + std::to_string(left));
}

}  // namespace cloudbake
