// How signals end the program: with nothing left behind, and by the exit codes of the README.
#pragma once

#include <sys/types.h>

#include <span>

namespace cloudbake {

/// From now on a signal that ends the program first removes its temporary files. What is ignored stays ignored, as under nohup. A limit on
/// file sizes becomes an error of writing. Standard streams that are closed become ones that cannot be used, so that no other file gets
/// their numbers.
void prepareForSignals();

/// Installs a handler for a signal, unless it is ignored.
void handleSignal(int signal, void (*handler)(int));

/// A handler: removes the temporary files and ends the program by this signal.
void endBySignal(int signal);

/// A signal that asks a worker to stop, and the one that the supervisor passes on for it. A worker ignores the former, if they are not the
/// same, because a terminal sends it to all of its processes. The console of Windows has told the worker already.
struct WorkerSignal {
  int original, passed_on;
};
std::span<const WorkerSignal> workerSignals();
void passSignalOn(pid_t worker, int signal);

/// Whether a process that this signal ended was writing to a pipe that nobody reads.
bool isBrokenPipe(int signal);

}  // namespace cloudbake
