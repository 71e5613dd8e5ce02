// Feeds the fuzz targets of the readers without libFuzzer:
//   reader_fuzz [TARGET …] [--runs N] [--seed S]    damaged seeds; of all targets where none is named
//   reader_fuzz TARGET --files FILE …               replays inputs and says what they are
//   reader_fuzz TARGET --write-seeds FOLDER         seeds for libFuzzer, and the tokens as FOLDER.dict
// Input k of a seed is a function of both. An input that crashes or takes too long is written to reader-TARGET-SEED-RUN.bin.
#include <sys/resource.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "core/random.h"
#include "tests/fuzz/reader_fuzz.h"
#include "tests/fuzz/work.h"

// There where the program is built with a sanitizer.
extern "C" [[gnu::weak]] void __sanitizer_set_death_callback(void (*callback)());

namespace cloudbake {

namespace {

constexpr size_t kMaxBytes = 32768;

bool isSanitized() { return __sanitizer_set_death_callback != nullptr; }

struct Random {
  uint64_t state;
  uint64_t operator()() { return mix64(state += kGolden64); }
  size_t below(size_t count) { return count == 0 ? 0 : (*this)() % count; }
};

// What is under way, for a crash.
std::string current_input, current_name;

void saveCurrent() {
  std::ofstream(current_name, std::ios::binary) << current_input;
  std::fprintf(stderr, "reader_fuzz: input saved as %s\n", current_name.c_str());
}
void onSignal(int signal) {
  std::signal(signal, SIG_DFL);
  saveCurrent();
  std::raise(signal);
}

std::string readBytes(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) {
    std::fprintf(stderr, "reader_fuzz: cannot open %s\n", file.c_str());
    std::exit(2);
  }
  return {std::istreambuf_iterator<char>(stream), {}};
}

// One to four of: another byte, bytes gone, doubled, cut, a token or a number put in or over.
std::string damaged(std::string bytes, Random& random, const std::vector<std::string>& tokens) {
  constexpr uint32_t kWords[] = {0, 1, 0x7FFFFFFF, 0xFFFFFFFF, 0x10000000, 0x7F800000, 0x7FC00000};
  constexpr const char* kTexts[] = {"nan", "1e39", "-1", "99999999999", "\n", "", "\"", "[", "{", "0"};
  for (size_t changes = size_t(1) << random.below(3); changes > 0; --changes) {
    const size_t at = random.below(bytes.size() + 1), length = size_t(1) << random.below(7);
    const auto word = kWords[random.below(std::size(kWords))];
    switch (random.below(8)) {
      case 0: bytes.replace(at, 1, 1, char(random())); break;
      case 1: bytes.erase(at, length); break;
      case 2: bytes.insert(at, bytes.substr(at, length)); break;
      case 3: bytes.replace(at, 4, reinterpret_cast<const char*>(&word), 4); break;
      case 4: bytes.resize(random.below(4) == 0 ? at : bytes.size()); break;
      case 5: bytes.insert(at, kTexts[random.below(std::size(kTexts))]); break;
      case 6: bytes.replace(at, 1, kTexts[random.below(std::size(kTexts))]); break;
      default: bytes.insert(at, tokens[random.below(tokens.size())]); break;
    }
  }
  return bytes;
}

// Reads one input; false where it takes too long.
bool readInput(const ReaderTarget& target, uint64_t& read, std::string& message) {
  const double start = cpuSeconds();
  read += target.run(current_input, message);
  const double seconds = cpuSeconds() - start;
  if (!isTooLong(seconds / target.cost, isSanitized())) return true;
  std::fprintf(stderr, "reader_fuzz: %.1f seconds\n", seconds);
  saveCurrent();
  return false;
}

bool runTarget(const ReaderTarget& target, uint64_t runs, uint64_t seed) {
  const std::vector<std::string> seeds = target.seeds();
  const double start = cpuSeconds();
  uint64_t read = 0;
  std::string message;
  bool sound = true;
  for (uint64_t run = 0; run < runs && sound; ++run) {
    Random random{mix64((seed + 1) * kGolden64) + run};
    const Damage damage = [&](std::string bytes) { return damaged(std::move(bytes), random, target.tokens); };
    const std::string& original = seeds[random.below(seeds.size())];
    current_name = "reader-" + std::string(target.name) + "-" + std::to_string(seed) + "-" + std::to_string(run) + ".bin";
    // The seeds themselves come first, unharmed.
    current_input = run < seeds.size() ? seeds[run] : target.mutate ? target.mutate(original, random(), damage) : damage(original);
    if (current_input.size() > kMaxBytes) current_input.resize(kMaxBytes);
    sound = readInput(target, read, message);
  }
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const double seconds = cpuSeconds() - start;
  std::printf("%s: %llu inputs, %llu read; %.0f inputs/s, %ld MiB\n", std::string(target.name).c_str(),
              static_cast<unsigned long long>(runs), static_cast<unsigned long long>(read), double(runs) / seconds, usage.ru_maxrss / 1024);
  return sound;
}

bool replay(const ReaderTarget& target, const std::vector<std::string>& files) {
  bool sound = true;
  for (const std::string& file : files) {
    uint64_t read = 0;
    std::string message = "sound";
    current_name = file + ".again";
    current_input = readBytes(file);
    sound = readInput(target, read, message) && sound;
    std::printf("%s: %zu bytes → %s\n", file.c_str(), current_input.size(), read > 0 ? "sound" : message.c_str());
  }
  return sound;
}

void writeSeeds(const ReaderTarget& target, const std::string& folder) {
  std::filesystem::create_directories(folder);
  size_t number = 0;
  for (const std::string& seed : target.seeds()) std::ofstream(folder + "/seed_" + std::to_string(number++), std::ios::binary) << seed;
  std::ofstream dictionary(folder + ".dict");
  for (const std::string& token : target.tokens) {
    dictionary << '"';
    for (const char c : token) {
      char hex[8];
      std::snprintf(hex, sizeof hex, "\\x%02X", unsigned(static_cast<unsigned char>(c)));
      dictionary << hex;
    }
    dictionary << "\"\n";
  }
}

}  // namespace

}  // namespace cloudbake

int main(int count, char** arguments) {
  using namespace cloudbake;
  std::vector<const ReaderTarget*> targets;
  std::vector<std::string> files;
  std::string folder;
  uint64_t runs = 10'000, seed = 1;
  bool takes_files = false;
  for (int k = 1; k < count; ++k) {
    const std::string argument = arguments[k];
    const bool has_value = k + 1 < count;
    if (takes_files)
      files.push_back(argument);
    else if (argument == "--files")
      takes_files = true;
    else if (argument == "--runs" && has_value)
      runs = std::strtoull(arguments[++k], nullptr, 10);
    else if (argument == "--seed" && has_value)
      seed = std::strtoull(arguments[++k], nullptr, 10);
    else if (argument == "--write-seeds" && has_value)
      folder = arguments[++k];
    else if (const ReaderTarget* target = findReaderTarget(argument))
      targets.push_back(target);
    else {
      std::fprintf(stderr, "reader_fuzz: '%s' is no target; there are:", argument.c_str());
      for (const ReaderTarget& known : readerTargets()) std::fprintf(stderr, " %s", std::string(known.name).c_str());
      std::fprintf(stderr, "\nusage: reader_fuzz [TARGET …] [--runs N] [--seed S] [--write-seeds FOLDER] [--files FILE …]\n");
      return 2;
    }
  }
  if ((takes_files || !folder.empty()) && targets.size() != 1) {
    std::fprintf(stderr, "reader_fuzz: --files and --write-seeds need one target\n");
    return 2;
  }
  if (!folder.empty()) return writeSeeds(*targets[0], folder), 0;

  for (const int signal : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE}) std::signal(signal, onSignal);
  if (isSanitized()) __sanitizer_set_death_callback(saveCurrent);
  if (takes_files) return replay(*targets[0], files) ? 0 : 1;
  bool sound = true;
  if (targets.empty())
    for (const ReaderTarget& target : readerTargets()) targets.push_back(&target);
  for (const ReaderTarget* target : targets) sound = runTarget(*target, runs, seed) && sound;
  return sound ? 0 : 1;
}
