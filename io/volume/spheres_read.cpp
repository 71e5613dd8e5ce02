// Both formats are read as rows of four cells, which Cluster::add converts to spheres. Memory grows with the data, not with declared sizes.
#include "io/volume/spheres.h"

#include <algorithm>
#include <array>

#include "core/error.h"
#include "core/text/plain_text.h"
#include "core/text/scan.h"
#include "io/file/write_file.h"
#include "io/sculpt/ply_header.h"

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

// The numbers of a sphere, and the names of their columns in lower case, preferred names first.
constexpr std::array<const char*, 4> kParts{"x", "y", "z", "radius"};
constexpr std::array<std::array<std::string_view, 4>, 4> kNames{
    {{"x", "p[x]", "p[0]", "px"}, {"y", "p[y]", "p[1]", "py"}, {"z", "p[z]", "p[2]", "pz"}, {"radius", "pscale", "r", "scale"}}};

using Columns = std::array<size_t, 4>;

// The columns of x, y, z and the radius. `line` is the line with the names.
Columns findColumns(const fs::path& file, int line, std::vector<std::string> names) {
  for (std::string& name : names) name = lowerCase(name);
  const bool colored = std::find(names.begin(), names.end(), "g") != names.end();
  Columns columns{};
  for (size_t part = 0; part < 4; ++part) {
    auto found = names.end();
    for (const std::string_view name : kNames[part])
      if (found == names.end() && !(colored && name == "r")) found = std::find(names.begin(), names.end(), name);
    if (found == names.end() && part == 3)
      throw InputError(file.string(), line, "there is no radius; give every point a radius: pscale or radius");
    if (found == names.end())
      throw InputError(file.string(), line, std::string("there is no column '") + kParts[part] + "'; name the columns x, y, z and radius");
    columns[part] = size_t(found - names.begin());
  }
  return columns;
}

// The spheres read so far.
struct Cluster {
  const fs::path& file;
  std::string_view bytes;
  size_t most;
  std::vector<Sphere> spheres;

  // Adds the sphere of four numbers. `cells` are the texts of the numbers. `line` is 0 for binary files.
  void add(const std::array<std::optional<float>, 4>& numbers, const std::array<std::string_view, 4>& cells, int line) {
    for (size_t part = 0; part < 4; ++part) {
      if (!numbers[part]) fail(part, cells[part], line, "is not a number (" + quotedWord(cells[part]) + "); write it with a decimal point");
      if (!std::isfinite(*numbers[part]))
        fail(part, cells[part], line,
             "is " + (line > 0 ? quotedWord(cells[part]) + ", which is " : "") + "not finite in float32; repair the point or remove it");
    }
    if (*numbers[3] <= 0) fail(3, cells[3], line, "is not above 0; give the point a radius or remove it");
    if (spheres.size() == most)
      throw InputError(file.string(), line, "there are more than " + std::to_string(most) + " spheres; export fewer points");
    spheres.push_back({{*numbers[0], *numbers[1], *numbers[2]}, *numbers[3]});
  }

  [[noreturn]] void fail(size_t part, std::string_view cell, int line, const std::string& what) const {
    const size_t at = size_t(cell.data() - bytes.data()), line_end = at == 0 ? std::string::npos : bytes.rfind('\n', at - 1);
    const int column = line == 0 ? 0 : int(line_end == std::string::npos ? at + 1 : at - line_end);
    throw InputError(file.string(), line, column,
                     std::string("the ") + kParts[part] + " of point " + std::to_string(spheres.size()) + " " + what);
  }
};

void readPly(Cluster& cluster, PlyInput input) {
  const PlyHeader header = readPlyHeader(input);
  const auto vertex =
      std::find_if(header.elements.begin(), header.elements.end(), [](const PlyElement& element) { return element.name == "vertex"; });
  if (vertex == header.elements.end())
    throw InputError(cluster.file.string(), input.scanner.line, "the PLY has no element 'vertex'; export the points as vertices");
  std::vector<std::string> names;
  for (const PlyProperty& property : vertex->properties) names.push_back(property.length_type ? "" : property.name);
  const Columns columns = findColumns(cluster.file, vertex->line, names);

  std::vector<std::string_view> row_cells;
  for (auto element = header.elements.begin(); element != header.elements.end(); ++element)
    for (uint64_t row = 0; row < element->rows; ++row) {
      takePlyRow(input, header.format, *element, row, row_cells);
      if (element != vertex) continue;
      std::array<std::string_view, 4> cells;
      std::array<std::optional<float>, 4> numbers;
      for (size_t part = 0; part < 4; ++part) {
        cells[part] = row_cells[columns[part]];
        numbers[part] = plyNumber(cells[part], vertex->properties[columns[part]].type, header.format);
      }
      cluster.add(numbers, cells, header.format == PlyFormat::kText ? input.scanner.line : 0);
    }
}

// A cell without surrounding blanks and quotes.
std::string_view bareCell(std::string_view cell) {
  const auto trim = [&](std::string_view blanks) {
    while (!cell.empty() && blanks.find(cell.front()) != blanks.npos) cell.remove_prefix(1);
    while (!cell.empty() && blanks.find(cell.back()) != blanks.npos) cell.remove_suffix(1);
  };
  trim(" \t");
  trim("\"");
  return cell;
}

// The cells of a line, without empty ones at its end. A separator in quotes is part of its cell.
void splitLine(std::string_view line, char separator, std::vector<std::string_view>& cells) {
  cells.clear();
  bool quoted = false;
  for (size_t begin = 0, i = 0; i <= line.size(); ++i) {
    if (i < line.size() && line[i] == '"') quoted = !quoted;
    if (i < line.size() && (quoted || line[i] != separator)) continue;
    cells.push_back(bareCell(line.substr(begin, i - begin)));
    begin = i + 1;
  }
  while (!cells.empty() && cells.back().empty()) cells.pop_back();
}

char separatorOf(std::string_view line) {
  for (const char separator : {';', ','})
    if (line.find(separator) != line.npos) return separator;
  return '\t';
}

void readCsv(Cluster& cluster) {
  LineScanner scanner{cluster.bytes};
  const auto fail = [&](const std::string& what) { throw InputError(cluster.file.string(), scanner.line, what); };

  std::vector<std::string_view> row_cells;
  Columns columns{0, 1, 2, 3};
  size_t width = 0;  // number of columns in the first line; 0 before it is read
  char separator = ',';
  const auto counts = [&] { return std::to_string(row_cells.size()) + " values in " + std::to_string(width) + " columns"; };
  while (const auto line = scanner.next()) {
    if (bareCell(*line).starts_with('#')) continue;
    if (width == 0) separator = separatorOf(*line);
    splitLine(*line, separator, row_cells);
    if (row_cells.empty()) continue;

    // The first line has the names or the first sphere.
    if (width == 0) {
      width = row_cells.size();
      if (!parseNumber(row_cells[0])) {
        columns = findColumns(cluster.file, scanner.line, {row_cells.begin(), row_cells.end()});
        continue;
      }
      if (width != 4)
        fail("without a line of column names there must be four columns, not " + std::to_string(width) + "; write x,y,z,radius");
    }

    if (row_cells.size() > width)
      fail(counts() + ": too many; put text in quotes, write numbers with a decimal point and a vector as three columns");
    std::array<std::string_view, 4> cells;
    std::array<std::optional<float>, 4> numbers;
    for (size_t part = 0; part < 4; ++part) {
      if (columns[part] >= row_cells.size()) fail(counts() + ": too few; complete the row or remove it");
      cells[part] = row_cells[columns[part]];
      numbers[part] = parseFloat(cells[part]);
    }
    cluster.add(numbers, cells, scanner.line);
  }
}

}  // namespace

SphereFormat sphereFormatOf(const fs::path& file) {
  const std::string extension = lowerCase(file.extension().string());
  if (extension == ".ply") return SphereFormat::kPly;
  if (extension == ".csv") return SphereFormat::kCsv;
  throw UsageError("--spheres: '" + (extension.empty() ? file : file.extension()).string() +
                   "' is not a format for spheres: use .ply or .csv");
}

std::vector<Sphere> readSpheres(const fs::path& file, size_t most) {
  sphereFormatOf(file);  // report a wrong name first
  return decodeSpheres(file, readFileBytes(file), most);
}

std::vector<Sphere> decodeSpheres(const fs::path& file, const std::string& bytes, size_t most) {
  const SphereFormat format = sphereFormatOf(file);
  std::string mended;
  const bool is_ply = format == SphereFormat::kPly;
  Cluster cluster{file, is_ply ? mendPly(file, bytes, mended) : plainText(bytes, file.string(), mended), most, {}};
  is_ply ? readPly(cluster, openPly(file, cluster.bytes)) : readCsv(cluster);
  if (cluster.spheres.empty()) throw InputError(file.string(), "there are no spheres in it; export points with a radius");
  return std::move(cluster.spheres);
}

}  // namespace cloudbake
