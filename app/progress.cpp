// Bars are drawn on stderr below what was printed. Control sequences of ECMA-48 (CPL, ED) remove them before anything else is printed.
#include "app/progress.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "app/tell.h"
#include "app/terminal.h"
#include "core/memory_budget.h"
#include "core/parallel.h"
#include "core/text/markup.h"

namespace cloudbake {

namespace {

constexpr int kBarWidth = 24;
constexpr size_t kNarrowest = 50;  // columns for bars; a terminal that has fewer shows a count

// NO_COLOR disables colours if it is set to any text (no-color.org).
bool mayColour() {
  const char* forbidden = std::getenv("NO_COLOR");
  return forbidden == nullptr || *forbidden == '\0';
}

// As much of a line as fits: a character has at least as many bytes as columns, and is not cut.
std::string fitted(const std::string& line, size_t width) {
  size_t end = std::min(line.size(), width);
  while (end > 0 && end < line.size() && (static_cast<unsigned char>(line[end]) & 0xC0) == 0x80) --end;
  return line.substr(0, end);
}

std::string bar(double share) {
  const int full = int(std::lround(std::clamp(share, 0.0, 1.0) * kBarWidth));
  return "[" + std::string(size_t(full), '#') + std::string(size_t(kBarWidth - full), '.') + "]";
}

std::string duration(double seconds) {
  const int whole = int(std::lround(std::min(seconds, 359999.0)));
  if (whole >= 3600) return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
  return fmt::format("{}:{:02}", whole / 60, whole % 60);
}

}  // namespace

Stopwatch watchOnTerminal(bool quiet) {
  if (quiet || !isTerminal()) return {};
  return {nullptr, [](const StageWork& work) {
            constexpr double kLong_seconds = 10;
            const double seconds = work.processor_seconds / double(threadCount());
            if (seconds < kLong_seconds) return;
            say(stderr, fmt::format("cloudbake: {}: about {} (minutes:seconds) and {} of memory\n", work.what, duration(seconds),
                                    memoryText(work.bytes)));
          }};
}

Progress::Progress(bool quiet) : quiet_(quiet), bars_(!quiet && isTerminal()), colours_(mayColour()) {}

void Progress::begin(size_t assets, double cost_seconds) {
  const std::lock_guard lock(mutex_);
  total_ = assets;
  total_cost_ = cost_seconds;
  done_ = 0;
  done_cost_ = 0;
  start_ = Clock::now();
}

Progress::~Progress() { clear(); }

void Progress::start(const std::string& name, int stages) {
  const std::lock_guard lock(mutex_);
  running_[name] = {stages, 0, "begin"};
  draw(false);
}

void Progress::stage(const std::string& name, const std::string& finished) {
  const std::lock_guard lock(mutex_);
  Running& running = running_[name];
  ++running.done;
  running.last = finished;
  draw(false);
}

void Progress::finish(const std::string& name, double cost, const std::string& line) {
  const std::lock_guard lock(mutex_);
  running_.erase(name);
  ++done_;
  done_cost_ += cost;
  if (!bars_ && !quiet_ && !line.empty()) {
    std::printf("[%*zu/%zu] %s\n", int(std::to_string(total_).size()), done_, total_, onOneLine(line).c_str());
    std::fflush(stdout);
  }
  draw(done_ == total_);
}

void Progress::postpone(const std::string& name) {
  const std::lock_guard lock(mutex_);
  running_.erase(name);
}

void Progress::tell(const std::string& lines) {
  if (lines.empty()) return;
  const std::lock_guard lock(mutex_);
  clear();
  say(stderr, lines);
  draw(true);
}

void Progress::clear() {
  if (lines_ > 0) std::fprintf(stderr, "\x1b[%zuF\x1b[J", lines_);
  lines_ = 0;
}

std::string Progress::overallBar() const {
  const double seconds = std::chrono::duration<double>(Clock::now() - start_).count();
  const double share = total_cost_ > 0 ? done_cost_ / total_cost_ : 1;
  return fmt::format("{} {}/{}  {:.1f} assets/s  {}{}", bar(share), done_, total_, double(done_) / std::max(seconds, 1e-3),
                     duration(seconds), share > 0 ? ", " + duration(seconds * (1 - share) / share) + " left" : "");
}

std::string Progress::barOf(const std::string& name, const Running& running) const {
  return bar(double(running.done) / std::max(1, running.stages)) + " " + name + ": " + running.last;
}

void Progress::draw(bool now) {
  if (!bars_ || (!now && Clock::now() - drawn_ < std::chrono::milliseconds(80))) return;
  clear();
  drawn_ = Clock::now();
  const size_t width = terminalWidth() - 1;
  const bool has_bars = width >= kNarrowest;
  const auto put = [&](const std::string& line) {
    std::fprintf(stderr, "%s\n", fitted(onOneLine(line), width).c_str());
    ++lines_;
  };
  if (has_bars)
    for (const auto& [name, running] : running_) put(barOf(name, running));
  if (colours_) std::fputs("\x1b[1m", stderr);
  put(has_bars ? overallBar() : fmt::format("{}/{}", done_, total_));
  if (colours_) std::fputs("\x1b[0m", stderr);
  std::fflush(stderr);
}

}  // namespace cloudbake
