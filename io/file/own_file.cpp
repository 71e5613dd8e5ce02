#include "io/file/own_file.h"

#include "core/error.h"
#include "core/text/maker.h"
#include "io/file/write_file.h"

namespace cloudbake {

bool isForeignFile(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error) || std::filesystem::is_empty(file, error)) return false;
  try {
    return !namesMaker(readFileBytes(file));
  } catch (const Error&) {
    return true;
  }
}

}  // namespace cloudbake
