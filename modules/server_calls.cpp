#include "modules/open_module.h"
#include "modules/server.h"

namespace cloudbake {

std::unique_ptr<PageServer> openPageServer(int port, std::chrono::milliseconds request_time) {
  static const ServerModule& module = openModule<ServerModule>("libcloudbake_server.so");
  return module.openPageServer(port, request_time);
}

}  // namespace cloudbake
