// The worker writes to a pipe when an asset starts (+NAME), ends (-NAME) or stops to run again later (~NAME); what has started and not
// ended when it crashes is to blame.
// Its orders are a file in memory: what is done (-NAME), what runs alone (1NAME), and what crashed and by which signal (!NAME, then
// ?NUMBER). Each of these records ends in a NUL, because a name may have any other byte.
#include "app/supervise.h"

#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <cstring>
#include <set>

#include "app/signals.h"
#include "app/tell.h"
#include "core/text/scan.h"
#include "io/file/process.h"

namespace cloudbake {

namespace {

constexpr int kJournalDescriptor = 3, kOrdersDescriptor = 4;

std::atomic<pid_t> worker{0};
static_assert(std::atomic<pid_t>::is_always_lock_free);

// Passes signals on to the worker. Without one there is nothing to end in order.
void passSignalsOn() {
  for (const WorkerSignal& one : workerSignals())
    handleSignal(one.original, [](int signal) {
      const pid_t process = worker;
      if (process == 0)
        endBySignal(signal);
      else
        passSignalOn(process, signal);
    });
}

template <class Take>
void forRecords(std::string_view bytes, const Take& take) {
  for (size_t end; (end = bytes.find('\0')) != bytes.npos; bytes.remove_prefix(end + 1))
    if (end > 0) take(bytes[0], std::string(bytes.substr(1, end - 1)));
}

std::string recordOf(char kind, std::string_view text) { return kind + std::string(text) + '\0'; }

struct Journal {
  std::set<std::string> running, done;
};

Journal readJournal(std::string_view bytes) {
  Journal journal;
  forRecords(bytes, [&](char kind, const std::string& name) {
    if (kind == '+') journal.running.insert(name);
    if (kind == '-') journal.running.erase(name), journal.done.insert(name);
    if (kind == '~') journal.running.erase(name);
  });
  return journal;
}

std::string ordersText(const BatchOrders& orders) {
  std::string text;
  for (const std::string& name : orders.done) text += recordOf('-', name);
  for (const std::string& name : orders.alone) text += recordOf('1', name);
  for (const auto& [name, signal] : orders.crashed) text += recordOf('!', name) + recordOf('?', std::to_string(signal));
  return text;
}

// Runs a worker to its end.
ProcessEnd runWorker(const std::vector<std::string>& words, const BatchOrders& orders, Journal& journal) {
  std::vector<std::string> all{words.front(), kBatchWorker};
  all.insert(all.end(), words.begin() + 1, words.end());
  Descriptor file, to_read, to_write;
  openInMemory(file, ordersText(orders));
  openPipe(to_read, to_write);
  const Inherited inherited[] = {{kJournalDescriptor, to_write.number}, {kOrdersDescriptor, file.number}};
  worker = startProcess(thisProgram(), all, inherited);
  to_write.close();
  std::string bytes;
  readToEnd(to_read.number, bytes);
  const ProcessEnd end = waitForProcess(worker);
  worker = 0;
  journal = readJournal(bytes);
  return end;
}

// Standard input in memory, so that every worker can read it from the start.
void keepInput() {
  std::string bytes;
  if (const int error = readToEnd(STDIN_FILENO, bytes); error != 0)
    throw IoError("standard input", std::string("cannot be read: ") + std::strerror(error) + "; check where it comes from");
  Descriptor kept;
  openInMemory(kept, bytes);
  ::dup2(kept.number, STDIN_FILENO);
}

// What the end of a worker by a signal teaches the next one. Returns a line for the user.
std::string learn(const Journal& journal, int signal, BatchOrders& orders) {
  const bool is_fault = isFault(signal);
  const std::string name = "(" + signalText(signal) + ")", count = std::to_string(journal.running.size());
  const auto fail = [&](const std::string& what) {
    throw Error(is_fault ? ExitCode::kInternal : ExitCode::kSystem, "", 0, 0, what + "; run the batch again");
  };
  orders.done.insert(journal.done.begin(), journal.done.end());
  if (journal.running.size() == 1) {
    const std::string& asset = *journal.running.begin();
    if (!orders.crashed.emplace(asset, signal).second) fail("the program was ended twice with " + asset + " " + name);
    return (is_fault ? asset + " crashed the program " + name : "the program was killed " + name + " while " + asset + " was baked") +
           ": the batch goes on without it";
  }
  const size_t before = orders.alone.size();
  orders.alone.insert(journal.running.begin(), journal.running.end());
  if (orders.alone.size() == before)
    fail(std::string(is_fault ? "the batch crashed " : "the batch was killed ") + name + " between its assets");
  return (is_fault ? "one of " + count + " running assets crashed the program " + name
                   : "the program was killed " + name + " while " + count + " assets were baked") +
         ": each is tried alone";
}

}  // namespace

ExitCode superviseBatch(const std::vector<std::string>& words, bool reads_input) {
  if (reads_input) keepInput();
  passSignalsOn();
  BatchOrders orders;
  for (;;) {
    if (reads_input) ::lseek(STDIN_FILENO, 0, SEEK_SET);
    Journal journal;
    const auto [code, signal] = runWorker(words, orders, journal);
    if (signal == 0) return ExitCode(code);
    for (const auto& [original, passed_on] : workerSignals())
      if (signal == passed_on || signal == original) return ExitCode(128 + original);
    if (isBrokenPipe(signal)) return ExitCode::kBrokenPipe;
    say(stderr, "cloudbake: " + learn(journal, signal, orders) + "\n");
  }
}

BatchOrders takeOrders() {
  std::string bytes;
  if (readToEnd(kOrdersDescriptor, bytes) != 0) throw UsageError(std::string(kBatchWorker) + " is for `cloudbake batch` itself");
  BatchOrders orders;
  std::string crashed;
  forRecords(bytes, [&](char kind, const std::string& text) {
    if (kind == '-') orders.done.insert(text);
    if (kind == '1') orders.alone.insert(text);
    if (kind == '!') crashed = text;
    if (kind == '?') orders.crashed[crashed] = int(parseInteger(text).value_or(0));
  });
  return orders;
}

void JournalListener::start(const std::string& name, int stages) {
  writeAll(kJournalDescriptor, recordOf('+', name));
  next_.start(name, stages);
}

void JournalListener::finish(const std::string& name, double cost_seconds, const std::string& line) {
  writeAll(kJournalDescriptor, recordOf('-', name));
  next_.finish(name, cost_seconds, line);
}

void JournalListener::postpone(const std::string& name) {
  writeAll(kJournalDescriptor, recordOf('~', name));
  next_.postpone(name);
}

}  // namespace cloudbake
