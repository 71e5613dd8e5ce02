// The reader of the formats that assimp reads: libassimp takes longer to load than small bakes last, and only the child reader needs it.
#pragma once

#include "io/sculpt/read_mesh.h"

namespace cloudbake {

struct ForeignModule {
  const char* version;  ///< of cloudbake
  decltype(&cloudbake::readWithAssimp) readWithAssimp;
};

}  // namespace cloudbake
