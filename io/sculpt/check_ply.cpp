// assimp allocates memory for everything that a PLY declares before it looks at the data, and reads stale memory if the data ends too
// early. So every row is checked first.
#include "io/sculpt/ply_header.h"
#include "io/sculpt/read_mesh.h"

namespace cloudbake {

void checkPly(const std::filesystem::path& file, const std::string& bytes) {
  PlyInput input{file, bytes, {bytes}};
  const PlyHeader header = readPlyHeader(input);
  std::vector<std::string_view> cells;
  for (const PlyElement& element : header.elements)
    for (uint64_t row = 0; row < element.rows; ++row) takePlyRow(input, header.format, element, row, cells);
}

}  // namespace cloudbake
