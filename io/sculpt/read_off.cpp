// OFF: Geomview manual, "OFF Files" (The Geometry Center, 1996), as text: [ST][C][N]OFF, the numbers of vertices, faces and
// edges, a line per vertex (position, then normal, colour, UV as declared in the header), a line per face (size, corners, colour).
// This is a reader of our own, because assimp gives every corner its own vertex.
#include "core/error.h"
#include "core/text/scan.h"
#include "io/sculpt/read_mesh.h"
#include "io/sculpt/triangulate.h"

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

struct OffHeader {
  bool uvs = false, colors = false, normals = false;
  uint64_t vertices = 0, faces = 0;
};

// The subject of a line, for messages.
struct Owner {
  const char* name;
  std::optional<uint64_t> index{};
  std::string text() const { return index ? name + (" " + std::to_string(*index)) : name; }
};

// Iterates over the lines that contain more than a comment.
struct OffLines {
  const fs::path& file;
  LineScanner scanner;

  std::string_view next(const Owner& wanted) {
    while (const auto line = scanner.next()) {
      const std::string_view text = line->substr(0, line->find('#'));
      if (!std::all_of(text.begin(), text.end(), isBlank)) return text;
    }
    throw InputError(file.string(), scanner.line, "the OFF ends where " + wanted.text() + " should be; it is truncated, export it again");
  }
  [[noreturn]] void fail(const std::string& what) const { throw InputError(file.string(), scanner.line, what); }

  float number(std::string_view& text, const Owner& owner) const {
    const std::string_view word = takeWord(text);
    const auto value = parseFloat(word);
    if (!value || !std::isfinite(*value))
      fail("a number of " + owner.text() + " is not a finite number (" + quotedWord(word) + "); repair the file");
    return *value;
  }
  uint64_t count(std::string_view& text, const std::string& what) const {
    const std::string_view word = takeWord(text);
    const auto value = parseInteger(word);
    if (word.empty()) fail("the number of " + what + " is missing; export the file again");
    if (!value || *value < 0) fail("the number of " + what + " is " + quotedWord(word) + ", which is no count; export the file again");
    return uint64_t(*value);
  }
};

OffHeader readHeader(OffLines& lines, size_t file_bytes) {
  OffHeader header;
  std::string_view line = lines.next({"the header"}), word = takeWord(line);
  if (word.starts_with("ST")) header.uvs = true, word.remove_prefix(2);
  if (word.starts_with("C")) header.colors = true, word.remove_prefix(1);
  if (word.starts_with("N")) header.normals = true, word.remove_prefix(1);
  if (word != "OFF") lines.fail("not an OFF text in three dimensions (" + quotedWord(word) + "); export it as OFF, COFF, NOFF or STOFF");

  std::string_view probe = line;
  word = takeWord(probe);
  if (word == "BINARY") lines.fail("binary OFF is not supported; export it as text");
  if (word.empty()) line = lines.next({"the counts"});
  header.vertices = lines.count(line, "vertices");
  header.faces = lines.count(line, "faces");
  // A vertex takes at least "0 0 0\n", and a face "1 0\n".
  if (header.vertices > file_bytes / 6 + 1 || header.faces > file_bytes / 4 + 1)
    lines.fail("the OFF claims " + std::to_string(header.vertices) + " vertices and " + std::to_string(header.faces) +
               " faces in a file of " + std::to_string(file_bytes) + " bytes; it is damaged, export it again");
  return header;
}

void readVertex(OffLines& lines, const OffHeader& header, uint64_t index, SculptPart& part) {
  const Owner owner{"vertex", index};
  std::string_view line = lines.next(owner);
  const auto next = [&] { return lines.number(line, owner); };
  const auto next3 = [&] {
    const float x = next(), y = next(), z = next();
    return Vec3{x, y, z};
  };
  part.positions.push_back(next3());
  if (header.normals) part.normals.push_back(next3());
  if (!header.uvs) return;
  // The UV is the last pair of numbers in the line, after a colour of any length.
  std::vector<float> numbers;
  for (std::string_view probe = line; !takeWord(probe).empty(); probe = line) numbers.push_back(next());
  if (numbers.size() < 2) lines.fail(owner.text() + " has no UV, but the header declares UVs; export the file again");
  part.uvs.push_back({numbers[numbers.size() - 2], 1 - numbers.back()});
}

}  // namespace

SculptPart readOff(const fs::path& file, const std::string& bytes, Warnings& warnings) {
  OffLines lines{file, {bytes}};
  const OffHeader header = readHeader(lines, bytes.size());
  SculptPart part;
  part.name = file.stem().string();
  part.positions.reserve(header.vertices), part.triangles.reserve(header.faces);
  for (uint64_t i = 0; i < header.vertices; ++i) readVertex(lines, header, i, part);

  std::vector<uint32_t> corners;
  uint64_t small = 0, crossed = 0;
  for (uint64_t i = 0; i < header.faces; ++i) {
    const Owner owner{"face", i};
    std::string_view line = lines.next(owner);
    const uint64_t size = lines.count(line, "corners");
    if (size > line.size()) lines.fail(owner.text() + " claims " + std::to_string(size) + " corners; the file is damaged, export it again");
    corners.clear();
    for (uint64_t k = 0; k < size; ++k) {
      const std::string_view word = takeWord(line);
      const auto index = parseInteger(word);
      if (!index || *index < 0 || uint64_t(*index) >= header.vertices)
        lines.fail(owner.text() +
                   (word.empty() ? " has fewer corners than it claims"
                                 : " uses vertex " + (index ? std::to_string(*index) : quotedWord(word)) + " of " +
                                       std::to_string(header.vertices)) +
                   "; the file is damaged, export it again");
      corners.push_back(uint32_t(*index));
    }
    if (size < 3)
      ++small;
    else
      crossed += !triangulatePolygon(corners, part.positions, part.triangles);
  }
  warnings.add(WarningKind::kPartIgnored,
               file.string() + ": points and lines (faces with fewer than three corners) have no surface and were ignored", small);
  warnings.add(WarningKind::kDegenerateTriangle, file.string() + ": polygons that intersect themselves were cut as a fan", crossed);
  return part;
}

}  // namespace cloudbake
