#include "io/file/process.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <deque>

namespace cloudbake {

namespace {

[[noreturn]] void fail(const std::string& file, const std::string& what, int error, const std::string& cure = "") {
  throw IoError(file, what + ": " + std::strerror(error) + "; " + cure + "close other programs and try again");
}

// What other processes may know of the environment: where programs, libraries and folders are, and how to write to the terminal.
constexpr auto kPassedOn = std::to_array<const char*>({
  "PATH", "LD_LIBRARY_PATH", "HOME", "TMPDIR", "LANG", "LC_ALL", "TERM", "NO_COLOR",
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
      "LD_PRELOAD", "ASAN_OPTIONS", "LSAN_OPTIONS", "UBSAN_OPTIONS", "TSAN_OPTIONS",
#endif
});

std::vector<std::string> environmentOfChild() {
  std::vector<std::string> variables;
  for (const char* name : kPassedOn)
    if (const char* value = std::getenv(name)) variables.push_back(std::string(name) + "=" + value);
  return variables;
}

std::vector<char*> pointersTo(std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (std::string& text : texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  return pointers;
}

}  // namespace

void Descriptor::close() {
  if (number >= 0) ::close(number);
  number = -1;
}

int writeAll(int descriptor, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    bytes = bytes.subspan(size_t(written));
  }
  return 0;
}

int writeAll(int descriptor, std::string_view text) { return writeAll(descriptor, std::as_bytes(std::span(text.data(), text.size()))); }

int readToEnd(int descriptor, std::string& bytes) {
  std::array<char, 1 << 16> block{};
  for (ssize_t count; (count = ::read(descriptor, block.data(), block.size())) != 0;) {
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return errno;
    bytes.append(block.data(), size_t(count));
  }
  return 0;
}

void openPipe(Descriptor& to_read, Descriptor& to_write) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) fail("", "cannot create a pipe", errno);
  to_read.close(), to_write.close();
  to_read.number = ends[0], to_write.number = ends[1];
}

void openInMemory(Descriptor& file, std::string_view bytes) {
  file.close();
  file.number = ::memfd_create("cloudbake", MFD_CLOEXEC);
  const int error = file.number < 0 ? errno : writeAll(file.number, bytes);
  if (error != 0) fail("", "cannot create a file in memory", error);
  ::lseek(file.number, 0, SEEK_SET);
}

std::optional<std::filesystem::path> findProgram(std::string_view name) {
  const char* path = std::getenv("PATH");
  std::string_view rest = path ? path : "";
  while (!rest.empty()) {
    const size_t end = std::min(rest.find(':'), rest.size());
    const std::filesystem::path program = std::filesystem::path(rest.substr(0, end)) / name;
    std::error_code error;
    if (program.is_absolute() && std::filesystem::is_regular_file(program, error) && ::access(program.c_str(), X_OK) == 0) return program;
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return std::nullopt;
}

pid_t startProcess(const std::filesystem::path& program, std::vector<std::string> words, std::span<const Inherited> inherited) {
  if (!program.is_absolute()) throw IoError(program.string(), "cannot start this program: its path is not absolute");
  std::vector<std::string> variables = environmentOfChild();
  const std::vector<char*> arguments = pointersTo(words), environment = pointersTo(variables);

  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  std::deque<Descriptor> copies;  // above all numbers, so that no source is replaced before it is used
  for (const auto& [number, source] : inherited) {
    constexpr int kAboveAll = 16;
    if (source < 0)
      ::posix_spawn_file_actions_addopen(&actions, number, "/dev/null", O_RDWR, 0);
    else
      ::posix_spawn_file_actions_adddup2(&actions, copies.emplace_back(::fcntl(source, F_DUPFD_CLOEXEC, kAboveAll)).number, number);
  }
  pid_t process = 0;
  const int failure = ::posix_spawn(&process, program.c_str(), &actions, nullptr, arguments.data(), environment.data());
  ::posix_spawn_file_actions_destroy(&actions);
  if (failure != 0) fail(program.string(), "cannot start this program", failure, "check that it is installed, or ");
  return process;
}

bool isFault(int signal) {
  constexpr std::array kFaults{SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGSEGV, SIGSYS, SIGTRAP};
  return std::find(kFaults.begin(), kFaults.end(), signal) != kFaults.end();
}

int waitForProcess(pid_t process) {
  int status = 0;
  while (::waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

}  // namespace cloudbake
