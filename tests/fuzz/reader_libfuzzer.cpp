// The fuzz targets of the readers under libFuzzer. Its last argument names the target:
//   reader_libfuzzer CORPUS [-runs=N …] -ignore_remaining_args=1 TARGET
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "tests/fuzz/reader_fuzz.h"

static const cloudbake::ReaderTarget* target = nullptr;

extern "C" size_t LLVMFuzzerMutate(uint8_t* data, size_t size, size_t max_size);

extern "C" int LLVMFuzzerInitialize(int* count, char*** arguments) {
  target = cloudbake::findReaderTarget((*arguments)[*count - 1]);
  if (target) return 0;
  std::fprintf(stderr, "reader_libfuzzer: the last argument must name a target, behind -ignore_remaining_args=1\n");
  std::exit(2);
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  std::string message;
  target->run({reinterpret_cast<const char*>(data), size}, message);
  return 0;
}

extern "C" size_t LLVMFuzzerCustomMutator(uint8_t* data, size_t size, size_t max_size, unsigned seed) {
  if (!target->mutate) return LLVMFuzzerMutate(data, size, max_size);
  const auto damage = [&](std::string bytes) {
    std::string room = std::move(bytes);
    const size_t used = room.size();
    room.resize(std::max(max_size, used));
    room.resize(LLVMFuzzerMutate(reinterpret_cast<uint8_t*>(room.data()), used, room.size()));
    return room;
  };
  const uint64_t draw = seed * 0x9E3779B97F4A7C15ULL;
  const std::string mutated = target->mutate({reinterpret_cast<const char*>(data), size}, draw ^ draw >> 32, damage);
  const size_t kept = std::min(mutated.size(), max_size);
  std::memcpy(data, mutated.data(), kept);
  return kept;
}
