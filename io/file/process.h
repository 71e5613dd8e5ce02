// Other processes, and the pipes to them.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "io/file/descriptor.h"

namespace cloudbake {

/// The absolute path of the running program, to start it again.
std::filesystem::path thisProgram();

/// Opens a pipe whose ends other programs do not inherit. Throws IoError.
void openPipe(Descriptor& to_read, Descriptor& to_write);

/// A file in memory that holds `bytes`, to be read from its start. Throws IoError.
void openInMemory(Descriptor& file, std::string_view bytes);

/// A descriptor of a new process: `number` is its number there; without a source it is the null device.
struct Inherited {
  int number;
  int source = -1;
};

/// Starts a program, which is an absolute path. words[0] is the name that it is called by. It inherits the standard streams, what is
/// listed, and a few variables of the environment (posix/process.cpp and windows/process.cpp name them). Throws IoError if it cannot be
/// started.
pid_t startProcess(const std::filesystem::path& program, std::vector<std::string> words, std::span<const Inherited> inherited);

/// How a process ended: by itself with an exit code, or by a signal; 0 is none. On Windows an exception that ended it counts as the signal
/// of the same fault.
struct ProcessEnd {
  int code = 0, signal = 0;
};

/// Waits for the end of a process.
ProcessEnd waitForProcess(pid_t process);

/// Ends a process at once.
void killProcess(pid_t process);

/// Whether a signal that ended a process comes from a fault of its own; others are sent by the system or by hand.
bool isFault(int signal);
/// "Segmentation fault".
std::string signalText(int signal);

/// Waits until a pipe has bytes or is closed. Returns whether that is so before the time is over.
bool waitForBytes(int descriptor, std::chrono::milliseconds time);

/// From now on this process ends when its parent does.
void endWithParent();

/// Ends this process when it has computed for so many seconds, and refuses it more memory for its data than so many bytes. It leaves no
/// core file.
void limitThisProcess(uint64_t seconds, uint64_t memory);

/// What this process and those that it waited for have used.
struct ProcessUsage {
  double processor_seconds = 0;
  uint64_t peak_memory = 0;  ///< bytes
};
ProcessUsage usageOfProcesses();

}  // namespace cloudbake
