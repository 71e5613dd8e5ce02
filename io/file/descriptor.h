// Open files and pipes, as numbers of the C library, and what is written to and read from them.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace cloudbake {

/// A file descriptor that closes itself; -1 is none.
struct Descriptor {
  explicit Descriptor(int opened = -1) : number(opened) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() { close(); }
  void close();
  int number;
};

/// Writes all bytes. Returns 0 or the errno of the call that failed.
int writeAll(int descriptor, std::span<const std::byte> bytes);
int writeAll(int descriptor, std::string_view text);

/// Reads once into `bytes`, also after a signal. Returns the count, 0 at the end, or -1 and errno says why.
long readSome(int descriptor, std::span<std::byte> bytes);

/// Appends everything up to the end of the file or pipe. Returns 0 or the errno of the call that failed.
int readToEnd(int descriptor, std::string& bytes);

}  // namespace cloudbake
