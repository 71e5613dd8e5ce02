// Node's program has no server.
#include "app/view.h"
#include "core/error.h"

namespace cloudbake {

ExitCode serveView(const CommandLine&, const Settings&) {
  throw UsageError(
      "--serve and --watch are not in the program for Node: write the page with -o and open it, or install the native program");
}

}  // namespace cloudbake
