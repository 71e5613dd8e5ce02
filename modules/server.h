// The server of `view --serve`: cpp-httplib brings OpenSSL and Brotli, which take longer to load than small bakes last.
#pragma once

#include "io/http/page_server.h"

namespace cloudbake {

struct ServerModule {
  const char* version;  ///< of cloudbake
  decltype(&cloudbake::openPageServer) openPageServer;
};

}  // namespace cloudbake
