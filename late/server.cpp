// The server of `view --serve`: cpp-httplib brings OpenSSL and Brotli, which take longer to load than small bakes last.
#include "io/http/page_server.h"

#define LIBRARY server
#define FUNCTIONS(FUNCTION) \
  FUNCTION(std::unique_ptr<PageServer>, openPageServer, (int port, const PageServerLimits& limits), (port, limits))

#include "late/library.h"
