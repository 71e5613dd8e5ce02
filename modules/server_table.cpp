#include "modules/server.h"

extern "C" __attribute__((visibility("default")))
const cloudbake::ServerModule cloudbakeModule{CLOUDBAKE_VERSION, cloudbake::openPageServer};
