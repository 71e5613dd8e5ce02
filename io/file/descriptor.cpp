#include "io/file/descriptor.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>

namespace cloudbake {

namespace {

constexpr size_t kAtOnce = 1 << 30;  // Windows counts in 32 bits

}  // namespace

void Descriptor::close() {
  if (number >= 0) ::close(number);
  number = -1;
}

int writeAll(int descriptor, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const auto written = ::write(descriptor, bytes.data(), std::min(bytes.size(), kAtOnce));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    bytes = bytes.subspan(size_t(written));
  }
  return 0;
}

int writeAll(int descriptor, std::string_view text) { return writeAll(descriptor, std::as_bytes(std::span(text.data(), text.size()))); }

long readSome(int descriptor, std::span<std::byte> bytes) {
  for (;;) {
    const auto count = ::read(descriptor, bytes.data(), std::min(bytes.size(), kAtOnce));
    if (count >= 0 || errno != EINTR) return long(count);
  }
}

int readToEnd(int descriptor, std::string& bytes) {
  std::array<char, 1 << 16> block{};
  for (long count; (count = readSome(descriptor, std::as_writable_bytes(std::span(block)))) != 0;) {
    if (count < 0) return errno;
    bytes.append(block.data(), size_t(count));
  }
  return 0;
}

}  // namespace cloudbake
