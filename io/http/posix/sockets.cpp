#include "io/http/sockets.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <vector>

namespace cloudbake {

void closeSocket(Socket socket) { ::close(socket); }

long sendNow(Socket socket, const char* bytes, size_t size) { return long(::send(socket, bytes, size, MSG_NOSIGNAL)); }

long receiveNow(Socket socket, char* bytes, size_t size) { return long(::recv(socket, bytes, size, 0)); }

bool wouldWait() { return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR; }

Socket acceptNow(Socket listener) { return ::accept4(listener, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK); }

bool areTooManyOpen() { return errno == EMFILE || errno == ENFILE; }

bool waitFor(std::span<Waiting> all, int milliseconds) {
  std::vector<pollfd> asked;
  for (const auto& [socket, what, is_ready, is_gone] : all)
    asked.push_back({socket, short(what == Waiting::For::kBytes ? POLLIN : what == Waiting::For::kRoom ? POLLOUT : POLLRDHUP), 0});
  const int outcome = ::poll(asked.data(), asked.size(), milliseconds);
  if (outcome < 0 && errno != EINTR) return false;
  for (size_t i = 0; i < all.size(); ++i) {
    all[i].is_ready = outcome > 0 && asked[i].revents != 0;
    all[i].is_gone = outcome > 0 && (asked[i].revents & (POLLRDHUP | POLLHUP | POLLERR)) != 0;
  }
  return true;
}

WakeUp::WakeUp() : socket_(::eventfd(0, EFD_CLOEXEC)) {}

WakeUp::~WakeUp() { ::close(socket_); }

void WakeUp::wake() const {
  const uint64_t one = 1;
  (void)!::write(socket_, &one, sizeof one);
}

Socket listenOn(int port) {
  const auto refuse = [&](int socket) {
    const int error = errno;
    if (socket >= 0) ::close(socket);
    refusePort(port, error);
  };
  const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (socket < 0) refuse(socket);
  const int yes = 1;  // a port whose last server has just ended can be used again
  ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(uint16_t(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 || ::listen(socket, kBacklog) != 0) refuse(socket);
  return socket;
}

int portOf(Socket socket) {
  sockaddr_in address{};
  socklen_t size = sizeof address;
  ::getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size);
  return ntohs(address.sin_port);
}

}  // namespace cloudbake
