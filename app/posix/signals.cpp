// Sources: signal-safety(7); a program that a signal ends is to die of that signal, so that shells and Make see why it ended.
#include "app/signals.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <csignal>

#include "io/file/temporary_file.h"

namespace cloudbake {

namespace {

constexpr std::array<WorkerSignal, 3> kSignals{{{SIGINT, SIGUSR1}, {SIGTERM, SIGUSR2}, {SIGHUP, SIGALRM}}};

// What is written to the stand-in for standard output and standard error fails, and so does reading standard input.
void openClosedStreams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (::fcntl(stream, F_GETFD) < 0) (void)::open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
}

}  // namespace

void endBySignal(int signal) {
  removeTemporaryFiles();
  std::signal(signal, SIG_DFL);
  ::raise(signal);  // pending until the handler returns
}

void handleSignal(int signal, void (*handler)(int)) {
  struct sigaction action {};
  ::sigaction(signal, nullptr, &action);
  if (action.sa_handler == SIG_IGN) return;
  action = {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  ::sigaction(signal, &action, nullptr);
}

void prepareForSignals() {
  openClosedStreams();
  std::signal(SIGXFSZ, SIG_IGN);
  for (const int signal : {SIGHUP, SIGINT, SIGQUIT, SIGPIPE, SIGTERM, SIGXCPU}) handleSignal(signal, endBySignal);
}

std::span<const WorkerSignal> workerSignals() { return kSignals; }

void passSignalOn(pid_t worker, int signal) {
  for (const auto& [original, to_worker] : kSignals)
    if (signal == original) ::kill(worker, to_worker);
}

bool isBrokenPipe(int signal) { return signal == SIGPIPE; }

}  // namespace cloudbake
