// Source: Microsoft's reference of the Windows API, console control handlers. They run in a thread of their own.
#include "app/signals.h"

#include <windows.h>

#include <array>
#include <atomic>
#include <csignal>

#include "io/file/temporary_file.h"

namespace cloudbake {

namespace {

using Handler = void (*)(int);
std::atomic<Handler> of_interrupt{endBySignal}, of_end{endBySignal};

constexpr std::array<WorkerSignal, 2> kSignals{{{SIGINT, SIGINT}, {SIGTERM, SIGTERM}}};

std::atomic<Handler>& handlerOf(int signal) { return signal == SIGINT ? of_interrupt : of_end; }

BOOL WINAPI takeEvent(DWORD event) {
  const int signal = event == CTRL_C_EVENT ? SIGINT : SIGTERM;
  if (const Handler handler = handlerOf(signal)) handler(signal);
  // When this returns after these, Windows ends the program, after five seconds at the latest.
  if (event == CTRL_CLOSE_EVENT || event == CTRL_LOGOFF_EVENT || event == CTRL_SHUTDOWN_EVENT) ::Sleep(INFINITE);
  return TRUE;
}

}  // namespace

void endBySignal(int signal) {
  removeTemporaryFiles();
  ::ExitProcess(UINT(128 + signal));
}

void handleSignal(int signal, void (*handler)(int)) { handlerOf(signal) = handler; }

void prepareForSignals() { ::SetConsoleCtrlHandler(takeEvent, TRUE); }

std::span<const WorkerSignal> workerSignals() { return kSignals; }

void passSignalOn(pid_t, int) {}

bool isBrokenPipe(int) { return false; }

}  // namespace cloudbake
