// A batch of the program for Node has helpers in threads (pipeline/batch/wasm/helpers.h) and no process around it.
#include "app/supervise.h"

#include <cstring>

#include "core/error.h"
#include "core/wasm/host.h"

namespace cloudbake {

void prepareForHelpers(bool reads_input) {
  cloudbake_note_signals();
  if (!reads_input) return;
  if (const int error = cloudbake_keep_input(); error != 0)
    throw IoError("standard input", std::string("cannot be read: ") + std::strerror(error) + "; check where it comes from");
}

}  // namespace cloudbake
