// Other processes, and the pipes to them.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"

namespace cloudbake {

/// The absolute path of the running program, to start it again.
inline constexpr const char* kThisProgram = "/proc/self/exe";

/// A file descriptor that closes itself; -1 is none.
struct Descriptor {
  explicit Descriptor(int opened = -1) : number(opened) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() { close(); }
  void close();
  int number;
};

/// Writes all bytes. Returns 0 or the errno of the call that failed.
int writeAll(int descriptor, std::span<const std::byte> bytes);
int writeAll(int descriptor, std::string_view text);

/// Appends everything up to the end of the file or pipe. Returns 0 or the errno of the call that failed.
int readToEnd(int descriptor, std::string& bytes);

/// Opens a pipe whose ends other programs do not inherit. Throws IoError.
void openPipe(Descriptor& to_read, Descriptor& to_write);

/// A file in memory that holds `bytes`, to be read from its start. Throws IoError.
void openInMemory(Descriptor& file, std::string_view bytes);

/// A descriptor of a new process: `number` is its number there; without a source it is /dev/null.
struct Inherited {
  int number;
  int source = -1;
};

/// The program of this name in a folder of PATH. Folders that are relative or empty are skipped, because they are below the working folder.
std::optional<std::filesystem::path> findProgram(std::string_view name);

/// Starts a program, which is an absolute path. words[0] is the name that it is called by. It inherits the standard streams, what is
/// listed, and a few variables of the environment (process.cpp names them). Throws IoError if it cannot be started.
pid_t startProcess(const std::filesystem::path& program, std::vector<std::string> words, std::span<const Inherited> inherited);

/// Waits for the end of a process. Returns its status, as waitpid(2) does.
int waitForProcess(pid_t process);

/// Whether a signal that ended a process comes from a fault of its own; others are sent by the system or by hand.
bool isFault(int signal);

}  // namespace cloudbake
