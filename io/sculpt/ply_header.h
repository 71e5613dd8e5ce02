// Code shared by all readers of PLY: the header, and reading row by row, so that declared sizes are not trusted before the data is read.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/text/scan.h"

namespace cloudbake {

enum class PlyFormat { kText, kLittleEndian, kBigEndian };
enum class PlyType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::kFloat32;    ///< type of the scalar, or of a list's values
  std::optional<PlyType> length_type;  ///< type of a list's length; unset for a scalar
};

struct PlyElement {
  std::string name;
  uint64_t rows = 0;  ///< as declared, at most 2³² − 1
  std::vector<PlyProperty> properties;
  int line = 0;  ///< line of the header that declares it
};

struct PlyHeader {
  PlyFormat format = PlyFormat::kText;
  std::vector<PlyElement> elements;
  std::vector<std::string> textures;  ///< the images of all lines `comment TextureFile NAME`
};

/// The part of the file that is still to be read, with the place for messages.
struct PlyInput {
  const std::filesystem::path& file;
  LineScanner scanner;
  /// Throws InputError with `what` and the advice that the file is damaged.
  [[noreturn]] void fail(const std::string& what) const;
};

/// The bytes of a PLY without a byte-order mark; a text is mended as in core/text/plain_text.h.
std::string_view mendPly(const std::filesystem::path& file, std::string_view bytes, std::string& storage);

/// The beginning of a mended PLY. Lines of the header of a binary one may end in a carriage return alone.
PlyInput openPly(const std::filesystem::path& file, std::string_view mended);

/// Reads the header. The scanner is then at the first row. Throws InputError if the header is damaged.
PlyHeader readPlyHeader(PlyInput& input);

/// Reads row number `row` of an element from the input: per property the bytes or the word of a scalar, or those of
/// all values of a list.
/// Throws InputError if the file ends before the row does.
void takePlyRow(PlyInput& input, PlyFormat format, const PlyElement& element, uint64_t row, std::vector<std::string_view>& cells);

/// The number in a cell of takePlyRow; nothing if a word is not a number. A number beyond the range of float becomes infinite.
std::optional<float> plyNumber(std::string_view cell, PlyType type, PlyFormat format);

/// Removes one value from the front of a list's cell and returns it; the cell must not be empty.
std::string_view takePlyValue(std::string_view& cell, PlyType type, PlyFormat format);

/// The whole number in a value of a list; nothing if it is none.
std::optional<long long> plyIndex(std::string_view value, PlyType type, PlyFormat format);

}  // namespace cloudbake
