// The reader of the formats that assimp reads: libassimp takes longer to load than small bakes last, and only the child reader needs it.
#include "io/sculpt/read_mesh.h"

#define LIBRARY foreign
#define FUNCTIONS(FUNCTION)                                                                                                          \
  FUNCTION(Sculpt, readWithAssimp,                                                                                                   \
           (const std::filesystem::path& file, const std::string& bytes, const std::string& extension, const ReadSettings& settings, \
            Warnings& warnings),                                                                                                     \
           (file, bytes, extension, settings, warnings))

#include "late/library.h"
