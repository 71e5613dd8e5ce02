// Feeds the fuzz target of the L-systems without libFuzzer:
//   lsystem_fuzz [--runs N] [--seed S] [--jobs J] [--default-limits]   random inputs and mutated seeds, shared among J processes
//   lsystem_fuzz FILE …                                                replays inputs and says what they are
// Input k of a seed is a function of both. An input that crashes, takes too long or too much memory is written to fuzz-SEED-RUN.bin.
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "core/random.h"
#include "tests/folders.h"
#include "tests/fuzz/corpus.h"
#include "tests/fuzz/lsystem_fuzz.h"
#include "tests/fuzz/recipe_maker.h"
#include "tests/fuzz/work.h"

#if defined(__SANITIZE_ADDRESS__)
constexpr bool kSanitized = true;
extern "C" void __sanitizer_set_death_callback(void (*callback)());
// A small quarantine: its memory counts as the process's.
extern "C" const char* __asan_default_options() { return "quarantine_size_mb=16:malloc_context_size=4:max_allocation_size_mb=1024"; }
#else
constexpr bool kSanitized = false;
#endif

namespace cloudbake {

namespace {

constexpr long kMaxKilobytes = 1L << 20U;

using Bytes = std::vector<uint8_t>;

struct Options {
  uint64_t runs = 10'000, seed = 1, jobs = 1;
  bool default_limits = false;
  std::vector<std::string> files;
};

struct Summary {
  uint64_t runs = 0, grown = 0, failures = 0;
  double seconds = 0, slowest = 0, slowest_default = 0;
  uint64_t slowest_run = 0, slowest_default_run = 0;
  long kilobytes = 0;
};

// What a signal handler needs to save the input under way.
struct Current {
  const uint8_t* data = nullptr;
  size_t size = 0;
  char file[64] = "";
};
Current current;

void saveCurrent() {
  if (current.data == nullptr || current.file[0] == 0) return;
  const int file = open(current.file, O_WRONLY | O_CREAT | O_TRUNC, 0644);
  bool written = file >= 0 && write(file, current.data, current.size) == ssize_t(current.size);
  written = file >= 0 && close(file) == 0 && written;
  char line[128];
  const int length = std::snprintf(line, sizeof line, "lsystem_fuzz: %s %s\n", written ? "input saved as" : "cannot write", current.file);
  if (write(STDERR_FILENO, line, size_t(length)) < 0) _exit(1);
}

void onSignal(int signal) {
  saveCurrent();
  if (signal == SIGALRM) {
    constexpr char kText[] = "lsystem_fuzz: the input has no end\n";
    if (write(STDERR_FILENO, kText, sizeof kText - 1) < 0) _exit(1);
    _exit(1);
  }
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

// A stack of its own for the handlers, so that an overflow of the program's can be told.
void installHandlers() {
  static char stack[1U << 16U];
  const stack_t alternative{stack, 0, sizeof stack};
  sigaltstack(&alternative, nullptr);
  struct sigaction action {};
  action.sa_handler = onSignal;
  action.sa_flags = SA_ONSTACK;
  std::vector<int> signals{SIGABRT, SIGALRM};
  if (!kSanitized) signals.insert(signals.end(), {SIGSEGV, SIGBUS, SIGFPE, SIGILL});
  for (const int signal : signals) sigaction(signal, &action, nullptr);
#if defined(__SANITIZE_ADDRESS__)
  __sanitizer_set_death_callback(saveCurrent);
#endif
}

long peakKilobytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
}

Bytes readBytes(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) {
    std::fprintf(stderr, "lsystem_fuzz: cannot open %s\n", file.c_str());
    std::exit(2);
  }
  return {std::istreambuf_iterator<char>(stream), {}};
}

// --- Inputs ---

struct Seeds {
  std::vector<std::string> recipes, rules;
};

Seeds readSeeds() {
  Seeds seeds{{}, {kSeedRules.begin(), kSeedRules.end()}};
  for (const auto& entry : std::filesystem::directory_iterator(sourceFolder() / "data/presets")) {
    const Bytes bytes = readBytes(entry.path().string());
    seeds.recipes.emplace_back(bytes.begin(), bytes.end());
  }
  std::sort(seeds.recipes.begin(), seeds.recipes.end());
  return seeds;
}

// Up to 512 random bytes; three of four texts are mutated seeds instead, now and then with pieces of a second one.
Bytes makeInput(const Seeds& seeds, const Options& options, uint64_t run) {
  uint64_t stream = mix64(mix64((options.seed + 1) * kGolden64) + run);
  const auto draw = [&] { return mix64(stream += kGolden64); };
  Bytes input(kFuzzHeader + draw() % 510);
  for (uint8_t& byte : input) byte = uint8_t(draw() >> 32U);
  if (options.default_limits) input[1] = 0;
  if (!fuzzesText(input.data(), input.size()) || draw() % 4 == 0) return input;

  const auto& texts = input[2] % 2 == 0 ? seeds.recipes : seeds.rules;
  std::string text = texts[draw() % texts.size()];
  if (draw() % 4 == 0) {
    const std::string& other = texts[draw() % texts.size()];
    text.insert(draw() % text.size(), other.substr(draw() % other.size(), draw() % 64));
  }
  Choices choices{input.data(), input.size(), kFuzzHeader};
  mutateText(text, choices);
  input.resize(kFuzzHeader);
  input.insert(input.end(), text.begin(), text.end());
  return input;
}

// --- Runs ---

// One input; false where it breaks a promise, after saving it.
bool runInput(const Bytes& input, Summary& summary, uint64_t run) {
  current.data = input.data();
  current.size = input.size();
  alarm(unsigned(kHangs.count()));
  const double start = cpuSeconds();
  std::string problem, message;
  try {
    if (growFuzzInput(input.data(), input.size(), message)) ++summary.grown;
  } catch (const std::exception& error) {
    problem = std::string("an exception other than InputError: ") + error.what();
  }
  const double seconds = cpuSeconds() - start;
  alarm(0);

  ++summary.runs;
  summary.seconds += seconds;
  summary.kilobytes = peakKilobytes();
  const bool defaults = fuzzesDefaultLimits(input.data(), input.size());
  double& slowest = defaults ? summary.slowest_default : summary.slowest;
  if (seconds > slowest) {
    slowest = seconds;
    (defaults ? summary.slowest_default_run : summary.slowest_run) = run;
  }
  if (isTooLong(seconds, kSanitized && defaults)) problem = std::to_string(seconds) + " seconds";
  if (summary.kilobytes > kMaxKilobytes && summary.failures == 0)
    problem = "peak memory of " + std::to_string(summary.kilobytes / 1024) + " MiB";
  if (problem.empty()) return true;
  ++summary.failures;
  std::fprintf(stderr, "lsystem_fuzz: run %llu: %s\n", static_cast<unsigned long long>(run), problem.c_str());
  saveCurrent();
  return false;
}

void print(const Summary& s, double wall_seconds) {
  std::printf(
      "%llu inputs, %llu clouds, %llu failures; %.0f inputs/s, slowest %.3f s (run %llu), with default limits %.3f s (run %llu), %ld MiB\n",
      static_cast<unsigned long long>(s.runs), static_cast<unsigned long long>(s.grown), static_cast<unsigned long long>(s.failures),
      double(s.runs) / wall_seconds, s.slowest, static_cast<unsigned long long>(s.slowest_run), s.slowest_default,
      static_cast<unsigned long long>(s.slowest_default_run), s.kilobytes / 1024);
}

// Runs job, job + jobs, job + 2 jobs, …; stops after ten failures.
Summary runJob(const Options& options, uint64_t job) {
  const Seeds seeds = readSeeds();
  Summary summary;
  for (uint64_t run = job; run < options.runs && summary.failures < 10; run += options.jobs) {
    const Bytes input = makeInput(seeds, options, run);
    std::snprintf(current.file, sizeof current.file, "fuzz-%llu-%llu.bin", static_cast<unsigned long long>(options.seed),
                  static_cast<unsigned long long>(run));
    runInput(input, summary, run);
  }
  current.data = nullptr;
  return summary;
}

void merge(Summary& total, const Summary& part) {
  total.runs += part.runs;
  total.grown += part.grown;
  total.failures += part.failures;
  total.seconds += part.seconds;
  if (part.slowest > total.slowest) {
    total.slowest = part.slowest;
    total.slowest_run = part.slowest_run;
  }
  if (part.slowest_default > total.slowest_default) {
    total.slowest_default = part.slowest_default;
    total.slowest_default_run = part.slowest_default_run;
  }
  total.kilobytes = std::max(total.kilobytes, part.kilobytes);
}

// Each job in a process of its own, which reports through a pipe.
Summary runJobs(const Options& options) {
  if (options.jobs == 1) return runJob(options, 0);
  std::vector<int> pipes;
  for (uint64_t job = 0; job < options.jobs; ++job) {
    int ends[2];
    if (pipe(ends) != 0) std::exit(2);
    const pid_t child = fork();
    if (child < 0) std::exit(2);
    if (child == 0) {
      const Summary summary = runJob(options, job);
      std::exit(write(ends[1], &summary, sizeof summary) == ssize_t(sizeof summary) ? 0 : 2);
    }
    close(ends[1]);
    pipes.push_back(ends[0]);
  }
  Summary total;
  for (const int end : pipes) {
    Summary part;
    if (read(end, &part, sizeof part) == ssize_t(sizeof part))
      merge(total, part);
    else
      ++total.failures;  // the child died, and said why
    close(end);
  }
  for (int status = 0; wait(&status) > 0;)
    if (status != 0) total.failures = std::max<uint64_t>(total.failures, 1);
  return total;
}

Summary replay(const std::vector<std::string>& files) {
  Summary summary;
  for (const std::string& file : files) {
    const Bytes input = readBytes(file);
    std::string message;
    std::printf("%s: %zu bytes%s\n%s\n", file.c_str(), input.size(),
                fuzzesDefaultLimits(input.data(), input.size()) ? ", default limits" : "",
                describeFuzzInput(input.data(), input.size()).c_str());
    std::fflush(stdout);
    const double before = summary.seconds;
    runInput(input, summary, summary.runs);
    growFuzzInput(input.data(), input.size(), message);
    std::printf("→ %.3f s; %s\n", summary.seconds - before, message.empty() ? "a cloud" : message.c_str());
  }
  return summary;
}

Options readOptions(int count, char** arguments) {
  Options options;
  for (int k = 1; k < count; ++k) {
    const std::string argument = arguments[k];
    const auto number = [&] {
      if (k + 1 >= count || std::strspn(arguments[k + 1], "0123456789") != std::strlen(arguments[k + 1])) {
        std::fprintf(stderr, "lsystem_fuzz: %s needs a number\n", argument.c_str());
        std::exit(2);
      }
      return std::strtoull(arguments[++k], nullptr, 10);
    };
    if (argument == "--runs")
      options.runs = number();
    else if (argument == "--seed")
      options.seed = number();
    else if (argument == "--jobs")
      options.jobs = std::max<uint64_t>(1, number());
    else if (argument == "--default-limits")
      options.default_limits = true;
    else if (argument.starts_with("-")) {
      std::fprintf(stderr, "usage: lsystem_fuzz [--runs N] [--seed S] [--jobs J] [--default-limits] [FILE …]\n");
      std::exit(2);
    } else {
      options.files.push_back(argument);
    }
  }
  return options;
}

}  // namespace

}  // namespace cloudbake

int main(int count, char** arguments) {
  using namespace cloudbake;
  const Options options = readOptions(count, arguments);
  installHandlers();
  timespec start{}, end{};
  clock_gettime(CLOCK_MONOTONIC, &start);
  const Summary summary = options.files.empty() ? runJobs(options) : replay(options.files);
  clock_gettime(CLOCK_MONOTONIC, &end);
  print(summary, double(end.tv_sec - start.tv_sec) + 1e-9 * double(end.tv_nsec - start.tv_nsec));
  return summary.failures > 0 ? 1 : 0;
}
