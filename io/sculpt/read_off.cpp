// OFF: Geomview manual, "OFF Files" (The Geometry Center, 1996), as text: [ST][C][N]OFF, the numbers of vertices, faces and
// edges, a line per vertex (position, then normal, colour, UV as declared in the header), a line per face (size, corners, colour).
// This is a reader of our own, because assimp gives every corner its own vertex. MeshLab orders the letters otherwise; ModelNet40 writes
// the first number right after the header ("OFF8 12 0").
#include "core/error.h"
#include "core/text/plain_text.h"
#include "core/text/scan.h"
#include "io/sculpt/read_mesh.h"
#include "io/sculpt/triangulate.h"
#include "io/sculpt/vertex_colors.h"

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

// Takes ST, C and N from the front of the header's word, in any order.
OffHeader takeLetters(std::string_view& word) {
  OffHeader header;
  const auto take = [&](std::string_view letters, bool& is_there) {
    if (is_there || !word.starts_with(letters)) return false;
    word.remove_prefix(letters.size());
    return is_there = true;
  };
  while (take("ST", header.uvs) || take("C", header.colors) || take("N", header.normals)) {
  }
  return header;
}

OffHeader readHeader(OffLines& lines, size_t file_bytes) {
  std::string_view line = lines.next({"the header"}), probe = line, word = takeWord(probe);
  OffHeader header;
  if (!parseInteger(word)) {  // the keyword may be left out
    const std::string_view whole = word;
    header = takeLetters(word);
    if (!word.starts_with("OFF"))
      lines.fail("not an OFF text in three dimensions (" + quotedWord(whole) + "); export it as OFF, COFF, NOFF or STOFF");
    line = {word.data() + 3, size_t(line.data() + line.size() - word.data() - 3)};
    probe = line;
    word = takeWord(probe);
    if (word == "BINARY") lines.fail("binary OFF is not supported; export it as text");
    if (word.empty()) line = lines.next({"the counts"});
  }
  header.vertices = lines.count(line, "vertices");
  header.faces = lines.count(line, "faces");
  // A vertex takes at least "0 0 0\n", and a face "1 0\n".
  if (header.vertices > file_bytes / 6 + 1 || header.faces > file_bytes / 4 + 1)
    lines.fail("the OFF claims " + std::to_string(header.vertices) + " vertices and " + std::to_string(header.faces) +
               " faces in a file of " + std::to_string(file_bytes) + " bytes; it is damaged, export it again");
  return header;
}

// What is not read, for the warnings.
struct OffCounts {
  uint64_t small = 0, crossed = 0, uncolored = 0, more_numbers = 0, colored_faces = 0;
};

void readVertex(OffLines& lines, const OffHeader& header, uint64_t index, SculptPart& part, OffCounts& counts) {
  const Owner owner{"vertex", index};
  std::string_view line = lines.next(owner);
  const auto next = [&] { return lines.number(line, owner); };
  const auto next3 = [&] {
    const float x = next(), y = next(), z = next();
    return Vec3{x, y, z};
  };
  part.positions.push_back(next3());
  if (header.normals) part.normals.push_back(next3());
  std::vector<float> numbers;
  for (std::string_view probe = line; !takeWord(probe).empty(); probe = line) numbers.push_back(next());
  // The UV is the last pair of numbers in the line, after a colour of any length.
  if (header.uvs) {
    if (numbers.size() < 2) lines.fail(owner.text() + " has no UV, but the header declares UVs; export the file again");
    part.uvs.push_back({numbers[numbers.size() - 2], 1 - numbers.back()});
    numbers.resize(numbers.size() - 2);
  }
  if (!header.colors) {
    counts.more_numbers += !numbers.empty();
    return;
  }
  const bool has_color = numbers.size() == 3 || numbers.size() == 4;
  counts.uncolored += !has_color;
  part.colors.push_back({1, 1, 1, 1});
  if (has_color) std::copy(numbers.begin(), numbers.end(), part.colors.back().begin());
}

void readFace(OffLines& lines, const OffHeader& header, uint64_t index, std::vector<uint32_t>& corners, SculptPart& part,
              OffCounts& counts) {
  const Owner owner{"face", index};
  std::string_view line = lines.next(owner);
  const uint64_t size = lines.count(line, "corners");
  if (size > line.size()) lines.fail(owner.text() + " claims " + std::to_string(size) + " corners; the file is damaged, export it again");
  corners.clear();
  for (uint64_t k = 0; k < size; ++k) {
    const std::string_view word = takeWord(line);
    const auto corner = parseInteger(word);
    if (!corner || *corner < 0 || uint64_t(*corner) >= header.vertices)
      lines.fail(owner.text() +
                 (word.empty() ? " has fewer corners than it claims"
                               : " uses vertex " + (corner ? std::to_string(*corner) : quotedWord(word)) + " of " +
                                     std::to_string(header.vertices)) +
                 "; the file is damaged, export it again");
    corners.push_back(uint32_t(*corner));
  }
  counts.colored_faces += !takeWord(line).empty();
  if (size < 3)
    ++counts.small;
  else
    counts.crossed += !triangulatePolygon(corners, part.positions, part.triangles);
}

// Alphas run as far as the colours do.
void decodeColors(SculptPart& part) {
  float largest = 0;
  for (const VertexColor& color : part.colors) largest = std::max(largest, *std::max_element(color.begin(), color.end()));
  const float full = fullColor(largest);
  decodeVertexColors(part.colors, full);
  for (VertexColor& color : part.colors) color[3] /= full;
}

}  // namespace

SculptPart readOff(const fs::path& file, const std::string& bytes, Warnings& warnings) {
  std::string mended;
  OffLines lines{file, {plainText(bytes, file.string(), mended)}};
  const OffHeader header = readHeader(lines, bytes.size());
  SculptPart part;
  part.name = file.stem().string();
  part.positions.reserve(header.vertices), part.triangles.reserve(header.faces);
  OffCounts counts;
  for (uint64_t i = 0; i < header.vertices; ++i) readVertex(lines, header, i, part, counts);
  std::vector<uint32_t> corners;
  for (uint64_t i = 0; i < header.faces; ++i) readFace(lines, header, i, corners, part, counts);
  decodeColors(part);
  const auto count = [&](WarningKind kind, const char* what, uint64_t number) { warnings.add(kind, file.string() + ": " + what, number); };
  count(WarningKind::kPartIgnored, "points and lines (faces with fewer than three corners) have no surface and were ignored", counts.small);
  count(WarningKind::kDegenerateTriangle, "polygons that intersect themselves were cut as a fan", counts.crossed);
  count(WarningKind::kMissingColor, "some vertices have a colour and others have none; these became white", counts.uncolored);
  count(WarningKind::kMaterialIgnored, "numbers after the position that the header does not declare are ignored", counts.more_numbers);
  count(WarningKind::kMaterialIgnored, "the colours of faces are not kept", counts.colored_faces);
  return part;
}

}  // namespace cloudbake
