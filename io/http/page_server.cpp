// Sources: RFC 9110 and 9112 (HTTP), the HTML standard, section Server-sent events.
//
// One thread waits for the requests of all connections (Lobby). cpp-httplib parses a request that is there and formats the response, each
// in a thread of a pool of fixed size. So no client keeps a thread busy but by not reading its response, and then not while others wait.
// docs/architecture.md, Difficult parts, says what this relies on.
#include "io/http/page_server.h"

#include <fmt/format.h>
#include <httplib.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <functional>
#include <list>
#include <mutex>
#include <stdexcept>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "core/error.h"
#include "io/http/sockets.h"

namespace cloudbake {

namespace {

static_assert(std::string_view(CPPHTTPLIB_VERSION).starts_with("0.11."),
              "process_request and svr_sock_ are insides of cpp-httplib 0.11: compare them with those of this version");
#if !defined(CPPHTTPLIB_OPENSSL_SUPPORT) && !defined(CLOUDBAKE_PORTABLE)
#error "The library was compiled with options (HTTPLIB_CFLAGS in CMakeLists.txt) on which the sizes of its structs depend"
#endif

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr size_t kLongestRequest = 16 << 10;  // bytes: the line, the headers and what follows
constexpr size_t kMostWaiting = 256;          // connections whose request is not there yet
constexpr milliseconds kGlance{100};          // how often a waiting thread looks whether the server stops, or its client is gone
constexpr int kMostStreams = 32;
constexpr size_t kThreads = kMostStreams + 16;

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

// A connection to a client that has sent its request, or as much as it will.
class Connection : public httplib::Stream {
 public:
  // `busy` counts the connections that have a thread or wait for one.
  Connection(Socket socket, std::string request, const Board& board, const std::atomic<size_t>& busy, milliseconds write_time)
      : socket_(socket), request_(std::move(request)), board_(board), busy_(busy), write_time_(write_time) {}
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  ~Connection() override { closeSocket(socket_); }

  ssize_t read(char* bytes, size_t size) override {
    const size_t count = request_.copy(bytes, size, read_);
    read_ += count;
    return ssize_t(count);
  }

  ssize_t write(const char* bytes, size_t size) override {
    long count = sendNow(socket_, bytes, size);
    if (count < 0 && wouldWait() && waitUntilRead()) count = sendNow(socket_, bytes, size);
    return count > 0 ? count : -1;
  }

  bool is_readable() const override { return read_ < request_.size(); }
  // Whether the client is still there.
  bool is_writable() const override {
    Waiting client{socket_, Waiting::For::kNothing};
    return waitFor({&client, 1}, 0) && !client.is_gone;
  }
  void get_remote_ip_and_port(std::string&, int&) const override {}
  void get_local_ip_and_port(std::string&, int&) const override {}
  // The library reads and writes by the functions above.
  socket_t socket() const override { return INVALID_SOCKET; }

 private:
  // Whether the client takes more in time, and before the server stops or another client needs the thread.
  bool waitUntilRead() const {
    for (const auto end = Clock::now() + write_time_; !board_.stops() && Clock::now() < end;) {
      Waiting client{socket_, Waiting::For::kRoom};
      if (!waitFor({&client, 1}, int(kGlance.count()))) return false;
      if (client.is_ready) return !client.is_gone;
      if (busy_ > kThreads) return false;
    }
    return false;
  }

  Socket socket_;
  std::string request_;
  size_t read_ = 0;
  const Board& board_;
  const std::atomic<size_t>& busy_;
  const milliseconds write_time_;
};

// Accepts connections and waits for the requests of all of them in one thread.
class Lobby {
 public:
  // Receives a socket with what its client has sent: a request, or part of one.
  using Receiver = std::function<void(Socket socket, std::string request)>;
  Lobby(Socket listener, milliseconds request_time, Receiver receive)
      : listener_(listener), request_time_(request_time), receive_(std::move(receive)) {}
  Lobby(const Lobby&) = delete;
  Lobby& operator=(const Lobby&) = delete;
  ~Lobby() {
    for (const Guest& guest : guests_) closeSocket(guest.socket);
  }

  // Runs until stop is called, in any order.
  void run() {
    for (;;) {
      std::vector<Waiting> all{{wake_.socket()}, {listener_}};
      for (const Guest& guest : guests_) all.push_back({guest.socket});
      if (!waitFor(all, millisecondsLeft()) || all[0].is_ready) return;
      auto guest = guests_.begin();
      for (size_t i = 2; i < all.size(); ++i) {
        const auto next = std::next(guest);
        if ((all[i].is_ready && hasSent(*guest)) || Clock::now() >= guest->end) dismiss(guest);
        guest = next;
      }
      if (all[1].is_ready) accept();
    }
  }

  void stop() const { wake_.wake(); }

 private:
  struct Guest {
    Socket socket;
    Clock::time_point end;
    std::string request{};
  };
  using Place = std::list<Guest>::iterator;

  int millisecondsLeft() const {
    if (guests_.empty()) return -1;
    return int(std::clamp<int64_t>(std::chrono::ceil<milliseconds>(guests_.front().end - Clock::now()).count(), 0, 1'000'000));
  }

  void accept() {
    for (;;) {
      const Socket socket = acceptNow(listener_);
      const bool is_full = socket < 0 && areTooManyOpen() && !guests_.empty();
      if (socket < 0 && !is_full) return;
      if (is_full || guests_.size() == kMostWaiting) {
        hasSent(guests_.front());  // its request may have come meanwhile
        dismiss(guests_.begin());
      }
      if (socket >= 0) guests_.push_back({socket, Clock::now() + request_time_});
    }
  }

  // Takes what a client has sent, and returns whether that is all that will be read: a request up to its empty line, as much as is allowed,
  // or all before the client's end.
  static bool hasSent(Guest& guest) {
    std::array<char, 4096> bytes{};
    const long count = receiveNow(guest.socket, bytes.data(), std::min(bytes.size(), kLongestRequest - guest.request.size()));
    if (count < 0 && wouldWait()) return false;
    if (count > 0) guest.request.append(bytes.data(), size_t(count));
    return count <= 0 || guest.request.find("\r\n\r\n") != std::string::npos || guest.request.size() == kLongestRequest;
  }

  void dismiss(Place guest) {
    if (guest->request.empty())
      closeSocket(guest->socket);
    else
      receive_(guest->socket, std::move(guest->request));
    guests_.erase(guest);
  }

  const Socket listener_;
  const WakeUp wake_;
  const milliseconds request_time_;
  const Receiver receive_;
  std::list<Guest> guests_;  // in the order in which they came
};

// --- Answers ---

class Answers : private httplib::Server {
 public:
  Answers(Board& board, Socket listener, const PageServerLimits& limits)
      : board_(board),
        listener_(listener),
        port_(portOf(listener)),
        limits_(limits),
        lobby_(listener, limits.request, [this](Socket socket, std::string request) { receive(socket, std::move(request)); }) {
    svr_sock_ = listener;  // the library takes the server for stopped without it
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
  // The thread that serves must have ended.
  ~Answers() override { closeSocket(listener_); }

  int port() const { return port_; }

  // Answers until end is called, in any order, and until all connections have ended.
  void serve() {
    httplib::ThreadPool threads(kThreads);
    threads_ = &threads;
    lobby_.run();
    threads.shutdown();
  }

  void end() const { lobby_.stop(); }

 private:
  void receive(Socket socket, std::string request) {
    const auto connection = std::make_shared<Connection>(socket, std::move(request), board_, busy_, limits_.write);
    if (!threads_ || svr_sock_ == INVALID_SOCKET) throw std::logic_error("PageServer: a request while nothing serves");
    ++busy_;
    threads_->enqueue([this, connection] {
      bool closed = false;
      process_request(*connection, true, closed, [](httplib::Request& one) {
        one.ranges.clear();  // the page is sent as a whole, and not packed: it does not go far
        for (const char* name : {"Range", "Accept-Encoding"}) one.headers.erase(name);
      });
      --busy_;
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
      return refuse(403, fmt::format("This server is only http://127.0.0.1:{}/.", port_));
    const std::string path = request.target.substr(0, request.target.find('?'));
    if (path != "/" && path != "/events") return refuse(404, "Only / and /events exist.");
    if (request.method != "GET" && request.method != "HEAD") {
      response.set_header("Allow", "GET, HEAD");
      return refuse(405, "Only GET and HEAD are allowed.");
    }
    response.status = 200;
    if (path == "/") return page(response);
    stream(request, response);
  }

  // All connections send the same bytes.
  void page(httplib::Response& response) {
    const std::shared_ptr<const std::string> bytes = board_.page();
    if (bytes->empty()) return response.set_content("", "text/html; charset=utf-8");
    response.set_content_provider(bytes->size(), "text/html; charset=utf-8", [bytes](size_t offset, size_t size, httplib::DataSink& sink) {
      return sink.write(bytes->data() + offset, size);
    });
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

  Board& board_;  // outlives all connections
  const Socket listener_;
  const int port_;
  const PageServerLimits limits_;
  std::atomic<size_t> busy_ = 0;
  httplib::ThreadPool* threads_ = nullptr;
  Lobby lobby_;
};

class HttplibPageServer : public PageServer {
 public:
  HttplibPageServer(int port, const PageServerLimits& limits) : answers_(board_, listenOn(port), limits) {}
  ~HttplibPageServer() override {
    board_.stop();
    answers_.end();
    if (server_.joinable()) server_.join();
  }

  int port() const override { return answers_.port(); }
  std::string address() const override { return fmt::format("http://127.0.0.1:{}/", port()); }

  void show(std::string page, std::string data) override {
    board_.show(std::move(page), std::move(data));
    if (!server_.joinable()) server_ = std::thread([this] { answers_.serve(); });
  }

  void fail(std::string data) override { board_.fail(std::move(data)); }

 private:
  Board board_;
  Answers answers_;
  std::thread server_;
};

}  // namespace

void refusePort(int port, int error) {
  const std::string cure = error == EADDRINUSE
                               ? "end the program that uses it, or give another: --serve PORT, or --serve 0 for any free one"
                           : error == EACCES ? "ports below 1024 belong to the system; give a higher one, or --serve 0 for any free one"
                                             : "try --serve 0, which takes any free one";
  throw IoError("", fmt::format("port {} of 127.0.0.1 cannot be used: {}; {}", port, std::strerror(error), cure));
}

std::unique_ptr<PageServer> openPageServer(int port, const PageServerLimits& limits) {
  return std::make_unique<HttplibPageServer>(port, limits);
}

}  // namespace cloudbake
