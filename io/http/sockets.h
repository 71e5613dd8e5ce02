// Sockets in one form for all systems: posix/sockets.cpp and windows/sockets.cpp.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace cloudbake {

/// A socket that nothing waits for: reading, writing and accepting return at once. -1 is none.
using Socket = int;

void closeSocket(Socket socket);

/// Bytes that were sent, or -1.
long sendNow(Socket socket, const char* bytes, size_t size);
/// Bytes that came, 0 after the other's end, or -1.
long receiveNow(Socket socket, char* bytes, size_t size);
/// Whether the last call failed only because it would have had to wait.
bool wouldWait();

/// A connection to accept, or -1.
Socket acceptNow(Socket listener);
/// Whether it failed because this process has as many files open as it may.
bool areTooManyOpen();

/// What is waited for, and whether it came.
struct Waiting {
  Socket socket = -1;
  enum class For { kBytes, kRoom, kNothing } what = For::kBytes;
  bool is_ready = false;  ///< also if the connection has failed
  bool is_gone = false;   ///< the other side has closed it
};
/// Waits so many milliseconds, without an end if they are negative. Returns false for a failure that will not go away.
bool waitFor(std::span<Waiting> all, int milliseconds);

/// Wakes a thread that waits for a socket.
class WakeUp {
 public:
  WakeUp();
  WakeUp(const WakeUp&) = delete;
  WakeUp& operator=(const WakeUp&) = delete;
  ~WakeUp();
  Socket socket() const { return socket_; }
  void wake() const;

 private:
  Socket socket_ = -1;
};

inline constexpr int kBacklog = 1024;  ///< connections that wait to be accepted

/// Throws the IoError for a port that cannot be used, with the errno of the failure.
[[noreturn]] void refusePort(int port, int error);

/// A socket that listens on a port of 127.0.0.1. Throws IoError.
Socket listenOn(int port);
int portOf(Socket socket);

}  // namespace cloudbake
