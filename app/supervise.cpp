// The worker writes a line to a pipe when an asset starts (+NAME) and ends (-NAME); what has started and not ended when it crashes is to
// blame. Orders are JSON: {"crashed": {NAME: WHY}, "alone": [NAME], "done": [NAME]}.
#include "app/supervise.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <nlohmann/json.hpp>
#include <set>

#include "app/tell.h"

namespace cloudbake {

namespace {

constexpr int kJournalDescriptor = 3;
constexpr const char* kProgram = "/proc/self/exe";
constexpr std::array<WorkerSignal, 2> kSignals{{{SIGINT, SIGUSR1}, {SIGTERM, SIGUSR2}}};

std::atomic<pid_t> worker{0};
static_assert(std::atomic<pid_t>::is_always_lock_free);

void passSignalsOn() {
  struct sigaction action {};
  action.sa_handler = [](int signal) {
    const pid_t process = worker;
    for (const auto& [original, passed_on] : kSignals)
      if (signal == original && process > 0) ::kill(process, passed_on);
  };
  action.sa_flags = SA_RESTART;
  for (const auto& [original, passed_on] : kSignals) ::sigaction(original, &action, nullptr);
}

struct Journal {
  std::set<std::string> running, done;
  void read(const std::string& line) {
    const std::string name = line.substr(1);
    if (line[0] == '+') running.insert(name);
    if (line[0] == '-') running.erase(name), done.insert(name);
  }
};

// Starts a worker and follows its journal to the end. Returns its wait status.
int runWorker(const std::vector<std::string>& words, const std::string& orders, Journal& journal) {
  std::vector<std::string> all{words.front(), kBatchWorker, orders};
  all.insert(all.end(), words.begin() + 1, words.end());
  std::vector<char*> arguments;
  for (std::string& word : all) arguments.push_back(word.data());
  arguments.push_back(nullptr);

  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) throw IoError("", std::string("cannot create a pipe to a worker: ") + std::strerror(errno));
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], kJournalDescriptor);
  pid_t process = 0;
  const int failure = ::posix_spawn(&process, kProgram, &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  ::close(ends[1]);
  if (failure != 0) throw IoError("", std::string("cannot start a worker for the batch: ") + std::strerror(failure));
  worker = process;

  std::string line;
  std::array<char, 4096> block{};
  for (ssize_t count; (count = ::read(ends[0], block.data(), block.size())) != 0;) {
    if (count < 0 && errno != EINTR) break;
    for (ssize_t i = 0; i < count; ++i) {
      if (block[size_t(i)] != '\n') {
        line += block[size_t(i)];
        continue;
      }
      if (!line.empty()) journal.read(line);
      line.clear();
    }
  }
  ::close(ends[0]);
  int status = 0;
  while (::waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  worker = 0;
  return status;
}

// Standard input in memory, so that every worker can read it from the start.
void keepInput() {
  const int kept = ::memfd_create("input", MFD_CLOEXEC);
  if (kept < 0) throw IoError("standard input", std::string("cannot be kept: ") + std::strerror(errno));
  std::array<char, 1 << 16> block{};
  for (ssize_t count; (count = ::read(STDIN_FILENO, block.data(), block.size())) != 0;) {
    if (count < 0 && errno == EINTR) continue;
    if (count < 0 || ::write(kept, block.data(), size_t(count)) != count)
      throw IoError("standard input", std::string("cannot be read: ") + std::strerror(errno));
  }
  ::dup2(kept, STDIN_FILENO);
  ::close(kept);
}

void note(const std::string& line) {
  for (size_t done = 0; done < line.size();) {
    const ssize_t count = ::write(kJournalDescriptor, line.data() + done, line.size() - done);
    if (count < 0 && errno != EINTR) return;  // nobody supervises
    if (count > 0) done += size_t(count);
  }
}

}  // namespace

std::span<const WorkerSignal> workerSignals() { return kSignals; }

ExitCode superviseBatch(const std::vector<std::string>& words, bool reads_input) {
  passSignalsOn();
  if (reads_input) keepInput();
  Json orders = {{"crashed", Json::object()}, {"alone", Json::array()}, {"done", Json::array()}};
  std::set<std::string> done;
  for (;;) {
    if (reads_input) ::lseek(STDIN_FILENO, 0, SEEK_SET);
    Journal journal;
    const int status = runWorker(words, orders.dump(-1, ' ', true, Json::error_handler_t::replace), journal);
    if (WIFEXITED(status)) return ExitCode(WEXITSTATUS(status));
    const int signal = WTERMSIG(status);
    for (const auto& [original, passed_on] : kSignals)
      if (signal == passed_on || signal == original) return ExitCode(128 + original);
    const std::string why = ::strsignal(signal);
    if (journal.running.empty()) throw Error(ExitCode::kInternal, "", 0, 0, "the batch crashed (" + why + ")");
    done.merge(journal.done);
    orders["done"] = done;
    orders["alone"] = Json::array();
    if (journal.running.size() == 1) {
      orders["crashed"][*journal.running.begin()] = why;
      say(stderr, "cloudbake: " + *journal.running.begin() + " crashed the program (" + why + "): the batch goes on without it\n");
    } else {
      orders["alone"] = journal.running;
      say(stderr, "cloudbake: one of " + std::to_string(journal.running.size()) + " running assets crashed the program (" + why +
                      "): each is tried alone\n");
    }
  }
}

void takeOrders(const std::string& orders, BatchSettings& batch) {
  try {
    const Json json = Json::parse(orders);
    json.at("crashed").get_to(batch.crashed);
    json.at("alone").get_to(batch.alone);
    json.at("done").get_to(batch.done);
  } catch (const Json::exception&) {
    throw UsageError(std::string(kBatchWorker) + " is for `cloudbake batch` itself");
  }
}

void JournalListener::start(const std::string& name, int stages) {
  note("+" + name + "\n");
  next_.start(name, stages);
}

void JournalListener::finish(const std::string& name, double cost_seconds, const std::string& line) {
  note("-" + name + "\n");
  next_.finish(name, cost_seconds, line);
}

}  // namespace cloudbake
