// The terminal that the program writes to.
#pragma once

#include <cstddef>

namespace cloudbake {

/// For the beginning of main: the words of the command line are UTF-8 afterwards, and what is printed reaches the terminal as it is.
void prepareTerminal(int& argc, char**& argv);

/// Whether standard error is a terminal that understands control sequences.
bool isTerminal();

/// Its columns.
size_t terminalWidth();

inline constexpr size_t kUsualWidth = 80;  ///< columns

}  // namespace cloudbake
