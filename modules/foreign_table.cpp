#include "modules/foreign.h"

extern "C" __attribute__((visibility("default")))
const cloudbake::ForeignModule cloudbakeModule{CLOUDBAKE_VERSION, cloudbake::readWithAssimp};
