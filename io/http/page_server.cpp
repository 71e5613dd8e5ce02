// Sources: RFC 9110 and 9112 (HTTP), the HTML standard, section Server-sent events.
//
// cpp-httplib parses requests and formats responses. A connection (Connection below) limits what it reads and for how long, because the
// library reads a line or a header of any length. Each connection occupies a thread of a pool of fixed size while it lasts.
#include "io/http/page_server.h"

#include <fmt/format.h>
#include <httplib.h>

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <mutex>
#include <thread>
#include <utility>

#include "core/error.h"

namespace cloudbake {

namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr size_t kLongestRequest = 16 << 10;  // bytes: the line, the headers and what follows
constexpr milliseconds kGlance{100};          // how often a waiting thread looks whether the server stops, or its client is gone
constexpr int kMostStreams = 32;
constexpr size_t kThreads = kMostStreams + 16;
constexpr int kBacklog = 128;

// --- What is shown ---

struct Event {
  uint64_t id = 0;  // 0: none
  std::shared_ptr<const std::string> data;
};

// The newest page, scene and failure, and who waits for newer ones.
class Board {
 public:
  // Ids begin at the time in milliseconds. So a page of an earlier server at this port knows smaller ones.
  Board() : last_id_(uint64_t(std::chrono::duration_cast<milliseconds>(std::chrono::system_clock::now().time_since_epoch()).count())) {}

  void show(std::string page, std::string data) {
    const std::lock_guard lock(mutex_);
    page_ = std::make_shared<const std::string>(std::move(page));
    scene_ = {++last_id_, std::make_shared<const std::string>(std::move(data))};
    failure_ = {};
    if (first_scene_ == 0) first_scene_ = scene_.id;
    changed_.notify_all();
  }

  void fail(std::string data) {
    const std::lock_guard lock(mutex_);
    failure_ = {++last_id_, std::make_shared<const std::string>(std::move(data))};
    changed_.notify_all();
  }

  void stop() {
    const std::lock_guard lock(mutex_);
    stops_ = true;
    changed_.notify_all();
  }

  bool stops() const { return stops_; }

  std::shared_ptr<const std::string> page() {
    const std::lock_guard lock(mutex_);
    return page_;
  }

  // What a page has that names this Last-Event-ID, or none.
  uint64_t knownTo(const std::string& last_event_id) {
    uint64_t id = 0;
    const char* const end = last_event_id.data() + last_event_id.size();
    const bool is_number = std::from_chars(last_event_id.data(), end, id) == std::from_chars_result{end, std::errc()};
    const std::lock_guard lock(mutex_);
    if (!is_number) return first_scene_;
    return id > last_id_ ? 0 : id;  // the clock was set back: nothing is known
  }

  // The text of what is newer than `known`, which is then known; empty if nothing is after `wait`, or if the server stops.
  std::string newerThan(uint64_t& known, milliseconds wait) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, wait, [&] { return stops_ || scene_.id > known || failure_.id > known; });
    const Event scene = scene_, failure = failure_;
    lock.unlock();
    std::string text;
    if (stops_) return text;
    if (scene.id > known) text += fmt::format("event: scene\nid: {}\ndata: {}\n\n", scene.id, *scene.data);
    if (failure.id > known) text += fmt::format("event: failure\nid: {}\ndata: {}\n\n", failure.id, *failure.data);
    known = std::max({known, scene.id, failure.id});
    return text;
  }

  // Counts a stream in, unless there are too many; it is counted out when the last copy of the result ends.
  std::shared_ptr<void> countIn() {
    if (++streams_ <= kMostStreams) return {this, [](Board* board) { --board->streams_; }};
    --streams_;
    return nullptr;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::shared_ptr<const std::string> page_;
  Event scene_, failure_;
  uint64_t last_id_, first_scene_ = 0;
  std::atomic<bool> stops_ = false;
  std::atomic<int> streams_ = 0;
};

// --- Connections ---

// A connection to a client, with limits.
class Connection : public httplib::Stream {
 public:
  Connection(int socket, const Board& board, const PageServerLimits& limits)
      : socket_(socket), board_(board), write_time_(limits.write), request_end_(Clock::now() + limits.request) {}
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  ~Connection() override { ::close(socket_); }

  // 0 at the end of what the client sends, or where a limit is.
  ssize_t read(char* bytes, size_t size) override {
    if (begin_ == end_) fill();
    const size_t count = std::min(size, end_ - begin_);
    std::memcpy(bytes, buffer_.data() + begin_, count);
    begin_ += count;
    return ssize_t(count);
  }

  ssize_t write(const char* bytes, size_t size) override {
    if (!waitFor(POLLOUT, Clock::now() + write_time_)) return -1;
    const ssize_t count = ::send(socket_, bytes, size, MSG_NOSIGNAL | MSG_DONTWAIT);
    return count > 0 ? count : -1;
  }

  bool is_readable() const override { return begin_ < end_; }
  // Whether the client is still there.
  bool is_writable() const override {
    pollfd client{socket_, POLLRDHUP, 0};
    return ::poll(&client, 1, 0) >= 0 && (client.revents & (POLLRDHUP | POLLHUP | POLLERR)) == 0;
  }
  void get_remote_ip_and_port(std::string&, int&) const override {}
  void get_local_ip_and_port(std::string&, int&) const override {}
  socket_t socket() const override { return socket_; }

 private:
  void fill() {
    begin_ = end_ = 0;
    if (budget_ == 0 || !waitFor(POLLIN, request_end_)) return;
    const ssize_t count = ::recv(socket_, buffer_.data(), std::min(buffer_.size(), budget_), MSG_DONTWAIT);
    if (count > 0) end_ = size_t(count), budget_ -= size_t(count);
  }

  // Whether the socket is ready before this time, and before the server stops.
  bool waitFor(short what, Clock::time_point until) const {
    while (!board_.stops()) {
      const auto left = std::chrono::duration_cast<milliseconds>(until - Clock::now());
      if (left.count() <= 0) return false;
      pollfd client{socket_, what, 0};
      const int ready = ::poll(&client, 1, int(std::min(left, kGlance).count()));
      if (ready > 0) return (client.revents & what) != 0;
      if (ready < 0 && errno != EINTR) return false;
    }
    return false;
  }

  int socket_;
  const Board& board_;
  const milliseconds write_time_;
  const Clock::time_point request_end_;
  size_t budget_ = kLongestRequest, begin_ = 0, end_ = 0;
  std::array<char, 4096> buffer_{};
};

// A socket that listens on 127.0.0.1, and its port.
int listenOn(int port) {
  const auto refuse = [&](int socket) {
    const int error = errno;
    if (socket >= 0) ::close(socket);
    const std::string cure = error == EADDRINUSE
                                 ? "end the program that uses it, or give another: --serve PORT, or --serve 0 for any free one"
                             : error == EACCES ? "ports below 1024 belong to the system; give a higher one, or --serve 0 for any free one"
                                               : "try --serve 0, which takes any free one";
    throw IoError("", fmt::format("port {} of 127.0.0.1 cannot be used: {}; {}", port, std::strerror(error), cure));
  };
  const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
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

int portOf(int socket) {
  sockaddr_in address{};
  socklen_t size = sizeof address;
  ::getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size);
  return ntohs(address.sin_port);
}

// --- Answers ---

class Answers : public httplib::Server {
 public:
  Answers(Board& board, int socket, const PageServerLimits& limits) : board_(board), port_(portOf(socket)), limits_(limits) {
    svr_sock_ = socket;
    new_task_queue = [] { return new httplib::ThreadPool(kThreads); };
    set_default_headers({{"Cache-Control", "no-store"},
                         {"X-Content-Type-Options", "nosniff"},
                         {"Cross-Origin-Resource-Policy", "same-origin"},
                         {"Accept-Ranges", "none"}});
    // The library's own routing would read a body first.
    set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
      answer(request, response);
      return HandlerResponse::Handled;
    });
  }
  // The thread that listens must have ended.
  ~Answers() override {
    if (svr_sock_ != INVALID_SOCKET) ::close(svr_sock_);
  }

  int port() const { return port_; }

  // Makes listen_after_bind return, if it runs.
  void end() {
    if (is_running() && svr_sock_ != INVALID_SOCKET) stop();
  }

 private:
  bool process_and_close_socket(socket_t socket) override {
    ::fcntl(socket, F_SETFD, FD_CLOEXEC);
    Connection connection(socket, board_, limits_);
    bool closed = false;
    return process_request(connection, true, closed, [](httplib::Request& request) {
      request.ranges.clear();  // the page is sent as a whole, and not packed: it does not go far
      for (const char* name : {"Range", "Accept-Encoding"}) request.headers.erase(name);
    });
  }

  // Whether a header appears once, and names this server after `scheme`.
  bool namesThis(const httplib::Request& request, const char* header, const std::string& scheme) const {
    const std::string value = request.get_header_value(header);
    for (const std::string host : {"127.0.0.1", "localhost"})
      if (value == scheme + host + ":" + std::to_string(port_) || (port_ == 80 && value == scheme + host))
        return request.get_header_value_count(header) == 1;
    return false;
  }

  void answer(const httplib::Request& request, httplib::Response& response) {
    const auto refuse = [&](int status, const std::string& text) {
      response.status = status;
      response.set_content(text + "\n", "text/plain; charset=utf-8");
    };
    if (!namesThis(request, "Host", "") || (request.has_header("Origin") && !namesThis(request, "Origin", "http://")))
      return refuse(403, fmt::format("This is http://127.0.0.1:{}/ and no other host.", port_));
    const std::string path = request.target.substr(0, request.target.find('?'));
    if (path != "/" && path != "/events") return refuse(404, "There are / and /events.");
    if (request.method != "GET" && request.method != "HEAD") {
      response.set_header("Allow", "GET, HEAD");
      return refuse(405, "There are GET and HEAD.");
    }
    response.status = 200;
    if (path == "/") return response.set_content(*board_.page(), "text/html; charset=utf-8");
    stream(request, response);
  }

  void stream(const httplib::Request& request, httplib::Response& response) {
    if (request.method == "HEAD") return response.set_header("Content-Type", "text/event-stream");
    const std::shared_ptr<void> counted = board_.countIn();
    if (!counted) {
      response.status = 503;
      return response.set_content("Too many pages are open.\n", "text/plain; charset=utf-8");
    }
    uint64_t known = board_.knownTo(request.get_header_value("Last-Event-ID"));
    // A page that breaks off tries again after a second. An id without data makes it name that id.
    const std::string greeting = fmt::format("retry: 1000\nid: {}\n\n", known);
    const auto send = [this, counted, known, text = greeting, quiet_since = Clock::now()](size_t, httplib::DataSink& sink) mutable {
      text += board_.newerThan(known, text.empty() ? kGlance : milliseconds(0));
      if (board_.stops() || !sink.is_writable()) return false;
      if (text.empty() && Clock::now() - quiet_since >= limits_.keep_alive) text = ":\n\n";
      if (text.empty()) return true;
      quiet_since = Clock::now();
      const std::string sent = std::exchange(text, "");
      return sink.write(sent.data(), sent.size());
    };
    response.set_content_provider("text/event-stream", send);
  }

  Board& board_;
  const int port_;
  const PageServerLimits limits_;
};

class HttplibPageServer : public PageServer {
 public:
  HttplibPageServer(int port, const PageServerLimits& limits) : answers_(board_, listenOn(port), limits) {}
  ~HttplibPageServer() override {
    board_.stop();
    if (!listener_.joinable()) return;
    while (!ended_) {  // it may not listen yet
      answers_.end();
      std::this_thread::sleep_for(milliseconds(1));
    }
    listener_.join();
  }

  int port() const override { return answers_.port(); }
  std::string address() const override { return fmt::format("http://127.0.0.1:{}/", port()); }

  void show(std::string page, std::string data) override {
    board_.show(std::move(page), std::move(data));
    if (listener_.joinable()) return;
    listener_ = std::thread([this] {
      answers_.listen_after_bind();
      ended_ = true;
    });
  }

  void fail(std::string data) override { board_.fail(std::move(data)); }

 private:
  Board board_;
  Answers answers_;
  std::atomic<bool> ended_ = false;
  std::thread listener_;
};

}  // namespace

std::unique_ptr<PageServer> openPageServer(int port, const PageServerLimits& limits) {
  return std::make_unique<HttplibPageServer>(port, limits);
}

}  // namespace cloudbake
