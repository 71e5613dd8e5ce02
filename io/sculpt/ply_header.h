// What every reader of PLY shares: the header, and rows taken one by one, so that nothing declared is believed before it is there.
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
  PlyType type = PlyType::kFloat32;    ///< of the scalar, or of a list's values
  std::optional<PlyType> length_type;  ///< of a list's length; nothing: a scalar
};

struct PlyElement {
  std::string name;
  uint64_t rows = 0;  ///< as declared, at most 2³² − 1
  std::vector<PlyProperty> properties;
  int line = 0;  ///< of the header, where it is declared
};

struct PlyHeader {
  PlyFormat format = PlyFormat::kText;
  std::vector<PlyElement> elements;
};

/// The file as far as it is read, for messages with a line.
struct PlyInput {
  const std::filesystem::path& file;
  const std::string& bytes;
  LineScanner scanner;
  /// Throws InputError: `what`, and that the file is damaged.
  [[noreturn]] void fail(const std::string& what) const;
};

/// Reads the header; the scanner then stands at the first row. Throws InputError where it is damaged.
PlyHeader readPlyHeader(PlyInput& input);

/// Takes row number `row` of an element off the input: per property the bytes or the word of a scalar, nothing for a list.
/// Throws InputError where the file ends before the row does.
void takePlyRow(PlyInput& input, PlyFormat format, const PlyElement& element, uint64_t row, std::vector<std::string_view>& cells);

/// The number in a cell of takePlyRow; nothing where a word is no number. What a float cannot hold becomes infinite.
std::optional<float> plyNumber(std::string_view cell, PlyType type, PlyFormat format);

}  // namespace cloudbake
