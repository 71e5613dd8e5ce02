// The program for Node is one module, with nothing that is opened late.
#include "io/file/own_library.h"

namespace cloudbake {

std::optional<std::filesystem::path> ownLibrary(std::string_view) { return std::nullopt; }

}  // namespace cloudbake
