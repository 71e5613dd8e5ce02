// A process is a copy of the program in a thread of Node (core/wasm/host.h). The signal of one that crashed is that which Linux would send.
#include "io/file/process.h"

#include <algorithm>
#include <array>
#include <csignal>
#include <cstring>

#include "core/wasm/host.h"

namespace cloudbake {

std::filesystem::path thisProgram() { return "/proc/self/exe"; }  // on every system: the host knows the file

void openPipe(Descriptor& to_read, Descriptor& to_write) {
  std::array<int, 2> ends{};
  cloudbake_pipe(ends.data());
  to_read.close(), to_write.close();
  to_read.number = ends[0], to_write.number = ends[1];
}

void openInMemory(Descriptor& file, std::string_view bytes) {
  file.close();
  file.number = cloudbake_memory_file(bytes.data(), bytes.size());
}

pid_t startProcess(const std::filesystem::path& program, std::vector<std::string> words, std::span<const Inherited> inherited) {
  if (program != thisProgram()) throw IoError(program.string(), "cannot start this program: the program for Node starts no other");
  std::string text;
  for (size_t i = 1; i < words.size(); ++i) text += words[i] + '\0';
  std::vector<int> pairs;
  for (const auto& [number, source] : inherited) pairs.insert(pairs.end(), {number, source});
  return cloudbake_start(text.data(), int(words.size()) - 1, pairs.data(), int(inherited.size()));
}

ProcessEnd waitForProcess(pid_t process) {
  ProcessEnd end;
  end.code = cloudbake_wait(process, &end.signal);
  return end;
}

void killProcess(pid_t process) { cloudbake_stop(process); }

bool isFault(int signal) {
  constexpr std::array kFaults{SIGABRT, SIGFPE, SIGILL, SIGSEGV};
  return std::find(kFaults.begin(), kFaults.end(), signal) != kFaults.end();
}

std::string signalText(int signal) { return ::strsignal(signal); }

bool waitForBytes(int descriptor, std::chrono::milliseconds time) {
  return cloudbake_wait_for_bytes(descriptor, double(time.count())) != 0;
}

void endWithParent() {}  // as threads do

// Its time is limited by the process that waits for it.
void limitThisProcess(uint64_t /*seconds*/, uint64_t memory) { cloudbake_limit_memory(double(memory)); }

ProcessUsage usageOfProcesses() {
  double seconds = 0, kilobytes = 0;
  cloudbake_usage(&seconds, &kilobytes);
  return {seconds, uint64_t(kilobytes) * 1024};
}

}  // namespace cloudbake
