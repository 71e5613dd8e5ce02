// Serves one page to the browsers of this machine, and sends them what is new.
#pragma once

#include <chrono>
#include <memory>
#include <string>

namespace cloudbake {

/// A server on the loopback interface, 127.0.0.1. It answers
/// - GET and HEAD of / with the page that show was given last;
/// - GET and HEAD of /events with a stream of server-sent events:
///   - `scene` with the data of the last show, to pages that do not have it yet;
///   - `failure` with the data of the last fail, unless a show followed.
///   Both have an increasing `id`, also across servers of one port, as long as the clock is not set back. A page that connects again and
///   names its Last-Event-ID gets what it missed. A page that names none is new: it has what / answered, so it gets a `scene` only if there
///   was more than one, and always the `failure`, if there is one. A comment every few seconds keeps the connection alive.
///
/// Every other path is 404, every other method 405. Requests for another host than 127.0.0.1:PORT or localhost:PORT (DNS rebinding), or
/// from a page of another origin, are 403. No file is ever read. A connection has one request; how long it may be and last is limited, and
/// so is the number of streams (503), of threads, and of connections whose request is not there yet: of these the oldest is closed for a
/// new one. From the first server on, the process ignores SIGPIPE.
class PageServer {
 public:
  virtual ~PageServer() = default;  ///< ends all connections

  virtual int port() const = 0;
  virtual std::string address() const = 0;  ///< "http://127.0.0.1:PORT/"

  /// Shows a page (HTML) from now on, and sends `data`, which has no line ends, to the pages that are open. The first call starts to
  /// answer; browsers that came before it have waited.
  virtual void show(std::string page, std::string data) = 0;

  /// Sends `data`, which has no line ends, as a failure. The page stays.
  virtual void fail(std::string data) = 0;
};

struct PageServerLimits {
  std::chrono::milliseconds request{2000};     ///< a request must be there after this time
  std::chrono::milliseconds write{10000};      ///< a client must take a byte in this time
  std::chrono::milliseconds keep_alive{5000};  ///< a stream that was quiet for this time gets a comment
};

/// Takes the port, 0 to 65535; 0 is any free one. Throws IoError if it is in use or not allowed.
std::unique_ptr<PageServer> openPageServer(int port, const PageServerLimits& limits = {});

}  // namespace cloudbake
