// The launcher takes the signals, and removes the temporary files (web/cli/cloudbake.mjs). A batch asks whether one came
// (pipeline/batch/wasm/make_assets.cpp), so a handler is never called.
#include "app/signals.h"

#include <array>
#include <csignal>

#include "core/wasm/host.h"

namespace cloudbake {

namespace {

constexpr std::array<WorkerSignal, 3> kSignals{{{SIGINT, SIGINT}, {SIGTERM, SIGTERM}, {SIGHUP, SIGHUP}}};

}  // namespace

void endBySignal(int) {}
void handleSignal(int, void (*)(int)) { cloudbake_note_signals(); }
void prepareForSignals() {}
std::span<const WorkerSignal> workerSignals() { return kSignals; }
void passSignalOn(pid_t, int) {}
bool isBrokenPipe(int signal) { return signal == SIGPIPE; }

}  // namespace cloudbake
