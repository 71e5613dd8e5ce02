// Linux can limit the data of a process (RLIMIT_DATA, setrlimit(2)); sanitizers reserve terabytes, so it is not limited in their builds.
#include "io/file/process.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
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

std::filesystem::path thisProgram() { return "/proc/self/exe"; }

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

std::string signalText(int signal) { return ::strsignal(signal); }

ProcessEnd waitForProcess(pid_t process) {
  int status = 0;
  while (::waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFSIGNALED(status) ? ProcessEnd{0, WTERMSIG(status)} : ProcessEnd{WEXITSTATUS(status), 0};
}

void killProcess(pid_t process) { ::kill(process, SIGKILL); }

bool waitForBytes(int descriptor, std::chrono::milliseconds time) {
  pollfd waiting{descriptor, POLLIN, 0};
  return ::poll(&waiting, 1, int(time.count())) > 0;
}

void endWithParent() { ::prctl(PR_SET_PDEATHSIG, SIGKILL); }

void limitThisProcess(uint64_t seconds, [[maybe_unused]] uint64_t memory) {
  const auto limit = [](auto resource, uint64_t most) {
    const rlimit value{most, most};
    ::setrlimit(resource, &value);
  };
  limit(RLIMIT_CPU, seconds);
  limit(RLIMIT_CORE, 0);
#if !defined(__SANITIZE_ADDRESS__)
  limit(RLIMIT_DATA, memory);
#endif
}

ProcessUsage usageOfProcesses() {
  const auto seconds = [](const timeval& time) { return double(time.tv_sec) + 1e-6 * double(time.tv_usec); };
  ProcessUsage all;
  for (const int who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
    rusage usage{};
    ::getrusage(who, &usage);
    all.processor_seconds += seconds(usage.ru_utime) + seconds(usage.ru_stime);
    all.peak_memory = std::max(all.peak_memory, uint64_t(usage.ru_maxrss) * 1024);
  }
  return all;
}

}  // namespace cloudbake
