// Source: Microsoft's reference of Windows Sockets 2. Handles of sockets are numbers that fit into 32 bits ("64-bit programming for 32-bit
// handles").
#include "io/http/sockets.h"

#include <winsock2.h>

#include <windows.h>
#include <ws2tcpip.h>

#include <cerrno>
#include <vector>

namespace cloudbake {

namespace {

SOCKET from(Socket socket) { return SOCKET(socket); }

Socket withoutWaiting(SOCKET socket) {
  if (socket == INVALID_SOCKET) return -1;
  u_long yes = 1;
  ::ioctlsocket(socket, FIONBIO, &yes);
  ::SetHandleInformation(reinterpret_cast<HANDLE>(socket), HANDLE_FLAG_INHERIT, 0);
  return Socket(socket);
}

sockaddr_in addressOf(int port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = ::htons(uint16_t(port));
  address.sin_addr.s_addr = ::htonl(INADDR_LOOPBACK);
  return address;
}

}  // namespace

void closeSocket(Socket socket) { ::closesocket(from(socket)); }

long sendNow(Socket socket, const char* bytes, size_t size) {
  constexpr size_t kAtOnce = 1 << 20;
  return ::send(from(socket), bytes, int(size < kAtOnce ? size : kAtOnce), 0);
}

long receiveNow(Socket socket, char* bytes, size_t size) { return ::recv(from(socket), bytes, int(size), 0); }

bool wouldWait() { return ::WSAGetLastError() == WSAEWOULDBLOCK; }

Socket acceptNow(Socket listener) { return withoutWaiting(::accept(from(listener), nullptr, nullptr)); }

bool areTooManyOpen() { return ::WSAGetLastError() == WSAEMFILE; }

bool waitFor(std::span<Waiting> all, int milliseconds) {
  std::vector<WSAPOLLFD> asked;
  for (const auto& [socket, what, is_ready, is_gone] : all)
    asked.push_back({from(socket), short(what == Waiting::For::kRoom ? POLLOUT : POLLIN), 0});
  if (::WSAPoll(asked.data(), ULONG(asked.size()), milliseconds) < 0) return false;
  for (size_t i = 0; i < all.size(); ++i) {
    all[i].is_ready = asked[i].revents != 0;
    char byte = 0;
    const bool is_closed =
        (asked[i].revents & POLLIN) != 0 && all[i].what == Waiting::For::kNothing && ::recv(asked[i].fd, &byte, 1, MSG_PEEK) == 0;
    all[i].is_gone = is_closed || (asked[i].revents & (POLLHUP | POLLERR)) != 0;
  }
  return true;
}

// A datagram to itself.
WakeUp::WakeUp() : socket_(withoutWaiting(::socket(AF_INET, SOCK_DGRAM, IPPROTO_UDP))) {
  const sockaddr_in any = addressOf(0);
  ::bind(from(socket_), reinterpret_cast<const sockaddr*>(&any), sizeof any);
  sockaddr_in own{};
  int size = sizeof own;
  ::getsockname(from(socket_), reinterpret_cast<sockaddr*>(&own), &size);
  ::connect(from(socket_), reinterpret_cast<const sockaddr*>(&own), sizeof own);
}

WakeUp::~WakeUp() { closeSocket(socket_); }

void WakeUp::wake() const { ::send(from(socket_), "1", 1, 0); }

Socket listenOn(int port) {
  const auto refuse = [&](Socket socket) {
    const int error = ::WSAGetLastError();
    if (socket >= 0) closeSocket(socket);
    refusePort(port, error == WSAEADDRINUSE ? EADDRINUSE : error == WSAEACCES ? EACCES : EIO);
  };
  const Socket socket = withoutWaiting(::socket(AF_INET, SOCK_STREAM, IPPROTO_TCP));
  if (socket < 0) refuse(socket);
  const BOOL yes = TRUE;  // nobody else may take the port meanwhile
  ::setsockopt(from(socket), SOL_SOCKET, SO_EXCLUSIVEADDRUSE, reinterpret_cast<const char*>(&yes), sizeof yes);
  const sockaddr_in address = addressOf(port);
  if (::bind(from(socket), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 || ::listen(from(socket), kBacklog) != 0)
    refuse(socket);
  return socket;
}

int portOf(Socket socket) {
  sockaddr_in address{};
  int size = sizeof address;
  ::getsockname(from(socket), reinterpret_cast<sockaddr*>(&address), &size);
  return ::ntohs(address.sin_port);
}

}  // namespace cloudbake
