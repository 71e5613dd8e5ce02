// The server over real sockets: what it answers, what it refuses, what open pages receive, and what clients cannot do to it.
#include "io/http/page_server.h"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <deque>
#include <functional>
#include <iterator>
#include <memory>
#include <optional>
#include <vector>

#include "tests/io/io_helpers.h"
#include "tests/wait.h"

namespace cloudbake {
namespace {

using std::chrono::hours;
using std::chrono::milliseconds;
const PageServerLimits kUnlimited{hours(9), hours(9), hours(9)};

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

// A socket to an IPv4 address, by default that of the server; -1 if it is refused.
int connectTo(int port, in_addr_t address = htonl(INADDR_LOOPBACK)) {
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(uint16_t(port));
  to.sin_addr.s_addr = address;
  const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (::connect(socket, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0) return socket;
  ::close(socket);
  return -1;
}

struct Client {
  explicit Client(const PageServer& server, const std::string& text = "") : socket(connectTo(server.port())) { send(text); }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;
  ~Client() { close(); }
  void close() {
    if (socket >= 0) ::close(socket);
    socket = -1;
  }
  void send(const std::string& text) const { ::send(socket, text.data(), text.size(), MSG_NOSIGNAL); }

  // Waits until the answer holds this text, or ends. Whether it holds it.
  bool receives(const std::string& text) {
    while (!contains(received, text) && !ended) {
      pollfd server{socket, POLLIN, 0};
      if (::poll(&server, 1, int(milliseconds(kHangs).count())) <= 0) break;
      std::array<char, 65536> bytes{};
      const ssize_t count = ::recv(socket, bytes.data(), bytes.size(), 0);
      if (count <= 0) ended = true;
      if (count > 0) received.append(bytes.data(), size_t(count));
    }
    return contains(received, text);
  }
  // The whole answer.
  const std::string& all() {
    receives("\1 no answer has this \1");
    EXPECT_TRUE(ended) << "the connection stays open after " << received;
    return received;
  }

  int socket;
  std::string received;
  bool ended = false;
};

std::string hostOf(const PageServer& server) { return "127.0.0.1:" + std::to_string(server.port()); }
std::string request(const PageServer& server, const std::string& line, const std::string& headers = "") {
  return line + " HTTP/1.1\r\nHost: " + hostOf(server) + "\r\n" + headers + "\r\n";
}
std::string answerTo(const PageServer& server, const std::string& text) { return Client(server, text).all(); }
// "200", or "none".
std::string codeOf(const std::string& answer) { return answer.starts_with("HTTP/1.1 ") ? answer.substr(9, 3) : "none"; }
std::string bodyOf(const std::string& answer) { return answer.substr(std::min(answer.find("\r\n\r\n"), answer.size() - 4) + 4); }
std::string codeFor(const PageServer& server, const std::string& line, const std::string& headers = "") {
  return codeOf(answerTo(server, request(server, line, headers)));
}

// The number after the last "id: ".
uint64_t idOf(const std::string& events) { return std::stoull(events.substr(events.rfind("\nid: ") + 5)); }
std::string lastEventId(uint64_t id) { return "Last-Event-ID: " + std::to_string(id) + "\r\n"; }

size_t entriesOf(const char* folder) {
  return size_t(std::distance(std::filesystem::directory_iterator(folder), std::filesystem::directory_iterator()));
}
size_t threadCount() { return entriesOf("/proc/self/task"); }
size_t handleCount() { return entriesOf("/proc/self/fd"); }
bool countsBecome(size_t threads, size_t handles) {
  return comesTrue([&] { return threadCount() == threads && handleCount() == handles; });
}

struct PageServerTest : testing::Test {
  PageServerTest() { server.show("<p>first</p>", "1"); }
  const std::unique_ptr<PageServer> opened = openPageServer(0, kUnlimited);
  PageServer& server = *opened;
};

// --- The page ---

TEST_F(PageServerTest, AnswersTheNewestPage) {
  EXPECT_EQ(server.address(), "http://" + hostOf(server) + "/");
  const std::string answer = answerTo(server, request(server, "GET /"));
  EXPECT_EQ(codeOf(answer), "200");
  EXPECT_EQ(bodyOf(answer), "<p>first</p>");
  for (const char* header : {"Content-Type: text/html; charset=utf-8", "Content-Length: 12", "Cache-Control: no-store",
                             "X-Content-Type-Options: nosniff", "Cross-Origin-Resource-Policy: same-origin", "Connection: close"})
    EXPECT_TRUE(contains(answer, std::string("\r\n") + header + "\r\n")) << header << " is not in " << answer;
  server.show("<p>second</p>", "2");
  EXPECT_EQ(bodyOf(answerTo(server, request(server, "GET /"))), "<p>second</p>");
  server.fail("\"wrong\"");
  EXPECT_EQ(bodyOf(answerTo(server, request(server, "GET /?look=plain"))), "<p>second</p>");
}

TEST_F(PageServerTest, SendsALargePageWhole) {
  std::string page(20'000'000, 'x');
  for (size_t i = 0; i < page.size(); ++i) page[i] = char('a' + i % 23);
  server.show(page, "2");
  EXPECT_EQ(bodyOf(answerTo(server, request(server, "GET /", "Range: bytes=0-9\r\nAccept-Encoding: br, gzip\r\n"))), page);
}

TEST_F(PageServerTest, AnswersHeadWithoutABody) {
  const std::string page = answerTo(server, request(server, "HEAD /"));
  EXPECT_EQ(codeOf(page), "200");
  EXPECT_TRUE(contains(page, "Content-Length: 12\r\n"));
  EXPECT_EQ(bodyOf(page), "");
  const std::string events = answerTo(server, request(server, "HEAD /events"));
  EXPECT_EQ(codeOf(events), "200");
  EXPECT_TRUE(contains(events, "Content-Type: text/event-stream\r\n"));
  EXPECT_EQ(bodyOf(events), "");
}

TEST(PageServer, BrowsersThatComeBeforeThePageWait) {
  const std::unique_ptr<PageServer> opened = openPageServer(0, kUnlimited);
  PageServer& server = *opened;
  Client early(server, request(server, "GET /"));
  server.show("late", "1");
  EXPECT_EQ(bodyOf(early.all()), "late");
}

// --- What is refused ---

TEST_F(PageServerTest, HasNoOtherPaths) {
  for (const std::string path : {"/favicon.ico",
                                 "/../etc/passwd",
                                 "/../../../../etc/passwd",
                                 "//",
                                 "//etc/passwd",
                                 "/.",
                                 "/..",
                                 "/./",
                                 "/%2e%2e/",
                                 "/%2e%2e/etc/passwd",
                                 "/%2f",
                                 "/%65vents",
                                 "/events/",
                                 "/events/..",
                                 "/EVENTS",
                                 "/index.html",
                                 "/\\..\\",
                                 "/%00",
                                 "*",
                                 "events",
                                 "etc/passwd",
                                 ".",
                                 "http://127.0.0.1/",
                                 "file:///etc/passwd",
                                 "/;",
                                 "/\xff\xfe"}) {
    const std::string answer = answerTo(server, request(server, "GET " + path));
    EXPECT_EQ(codeOf(answer), "404") << path;
    EXPECT_EQ(bodyOf(answer), "Only / and /events exist.\n") << path;
  }
  EXPECT_EQ(codeFor(server, "GET http://" + hostOf(server) + "/"), "404");
  EXPECT_EQ(codeFor(server, "GET /"), "200");
}

TEST_F(PageServerTest, HasNoOtherMethods) {
  for (const std::string method : {"POST", "PUT", "DELETE", "OPTIONS", "PATCH", "TRACE", "CONNECT"})
    for (const std::string path : {"/", "/events"}) {
      const std::string answer =
          answerTo(server, request(server, method + " " + path, "Content-Length: 100000\r\n") + std::string(60000, 'x'));
      EXPECT_EQ(codeOf(answer), "405") << method << path;
      EXPECT_TRUE(contains(answer, "\r\nAllow: GET, HEAD\r\n"));
    }
  EXPECT_EQ(codeFor(server, "POST /x", "Transfer-Encoding: chunked\r\n"), "404");
  EXPECT_EQ(codeFor(server, "get /"), "400");
  EXPECT_EQ(codeFor(server, "BREW /"), "400");
}

TEST_F(PageServerTest, AnswersToItsOwnNamesOnly) {
  const std::string port = std::to_string(server.port());
  const auto codeForHost = [&](const std::string& headers) { return codeOf(answerTo(server, "GET / HTTP/1.1\r\n" + headers + "\r\n")); };
  EXPECT_EQ(codeForHost("Host: localhost:" + port + "\r\n"), "200");
  EXPECT_EQ(codeForHost("host: 127.0.0.1:" + port + "\r\n"), "200");
  for (const std::string& host :
       std::vector<std::string>{"evil.example:" + port, "evil.example", "127.0.0.1", "localhost", "127.0.0.1:1" + port,
                                "127.0.0.1:" + port + "0", "127.0.0.1.evil.example:" + port, "[::1]:" + port, "0.0.0.0:" + port, ""})
    EXPECT_EQ(codeForHost("Host: " + host + "\r\n"), "403") << host;
  EXPECT_EQ(codeForHost(""), "403");
  EXPECT_EQ(codeForHost("Host: 127.0.0.1:" + port + "\r\nHost: evil.example\r\n"), "403");
  EXPECT_EQ(codeOf(answerTo(server, "GET /events HTTP/1.1\r\nHost: evil.example\r\n\r\n")), "403");
}

TEST_F(PageServerTest, RefusesPagesOfOtherOrigins) {
  EXPECT_EQ(codeFor(server, "GET /", "Origin: " + server.address().substr(0, server.address().size() - 1) + "\r\n"), "200");
  for (const char* origin : {"http://evil.example", "null", "https://localhost", "file://"})
    EXPECT_EQ(codeFor(server, "GET /events", std::string("Origin: ") + origin + "\r\n"), "403") << origin;
}

TEST_F(PageServerTest, LimitsTheRequest) {
  const std::string host = "Host: " + hostOf(server) + "\r\n";
  EXPECT_EQ(codeFor(server, "GET /" + std::string(10000, 'a')), "414");
  EXPECT_EQ(codeFor(server, "GET /", "X: " + std::string(10000, 'a') + "\r\n"), "400");
  EXPECT_EQ(codeFor(server, "GET /", "X: a\r\n"), "200");
  // Without an end, and more than is read.
  EXPECT_EQ(codeOf(answerTo(server, "GET /" + std::string(60000, 'a'))), "414");
  EXPECT_EQ(codeOf(answerTo(server, "GET / HTTP/1.1\r\n" + host + "X: " + std::string(60000, 'a'))), "400");
  std::string many = "GET / HTTP/1.1\r\n" + host;
  for (int i = 0; i < 6000; ++i) many += "X: a\r\n";
  EXPECT_EQ(codeOf(answerTo(server, many + "\r\n")), "400");
  EXPECT_EQ(codeFor(server, "GET /", "Range: bytes=" + std::string(2000, '1') + "\r\n"), "416");
  std::string ranges = "0-";
  while (ranges.size() < 8000) ranges += ",0-";
  EXPECT_EQ(bodyOf(answerTo(server, request(server, "GET /", "Range: bytes=" + ranges + "\r\n"))), "<p>first</p>");
  // Damaged.
  for (const std::string& text :
       {std::string("\r\n\r\n"), std::string("GET\r\n\r\n"), std::string("GET / HTTP/9.9\r\n\r\n"), std::string("GET / \r\n\r\n"),
        std::string("\0\0\0\r\n\r\n", 7), std::string("GET /\0 HTTP/1.1\r\n\r\n", 19), std::string("\x16\x03\x01\x02\n\r\n\r\n"),
        std::string(60000, '\n')})
    EXPECT_EQ(codeOf(answerTo(server, text)), "400");
  EXPECT_EQ(codeFor(server, "GET /"), "200");
}

TEST(PageServer, ARequestMustCome) {
  const std::unique_ptr<PageServer> server = openPageServer(0, {.request = milliseconds(50)});
  Client silent(*server), slow(*server, "GET / HT");  // sent before anything is read
  server->show("page", "1");
  EXPECT_EQ(silent.all(), "");
  EXPECT_EQ(codeOf(slow.all()), "400");
}

TEST_F(PageServerTest, OtherMachinesCannotConnect) {
  ifaddrs* all = nullptr;
  ASSERT_EQ(::getifaddrs(&all), 0);
  int tried = 0;
  for (const ifaddrs* one = all; one; one = one->ifa_next) {
    if (!one->ifa_addr || one->ifa_addr->sa_family != AF_INET) continue;
    const in_addr_t address = reinterpret_cast<const sockaddr_in*>(one->ifa_addr)->sin_addr.s_addr;
    if (address == htonl(INADDR_LOOPBACK)) continue;
    const int socket = connectTo(server.port(), address);
    EXPECT_EQ(socket, -1) << one->ifa_name;
    if (socket >= 0) ::close(socket);
    ++tried;
  }
  ::freeifaddrs(all);
  const int other_loopback = connectTo(server.port(), htonl(INADDR_LOOPBACK + 1));
  EXPECT_EQ(other_loopback, -1);
  if (tried == 0) std::puts("this machine has no address but the loopback's");
}

TEST_F(PageServerTest, APortIsTakenOnce) {
  expectError<IoError>([&] { openPageServer(server.port()); }, "port " + std::to_string(server.port()) + " of 127.0.0.1 cannot be used");
  expectError<IoError>([&] { openPageServer(server.port()); }, "--serve 0");
  EXPECT_EQ(codeFor(server, "GET /"), "200");
}

TEST(PageServer, APortIsFreeAfterItsServer) {
  int port = 0;
  {
    const std::unique_ptr<PageServer> first = openPageServer(0, kUnlimited);
    first->show("first", "1");
    port = first->port();
    EXPECT_EQ(bodyOf(answerTo(*first, request(*first, "GET /"))), "first");
  }
  const std::unique_ptr<PageServer> second = openPageServer(port, kUnlimited);
  EXPECT_EQ(second->port(), port);
  second->show("second", "1");
  EXPECT_EQ(bodyOf(answerTo(*second, request(*second, "GET /"))), "second");
}

// --- Events ---

TEST_F(PageServerTest, OpenPagesReceiveWhatIsNew) {
  Client page(server, request(server, "GET /events"));
  ASSERT_TRUE(page.receives("\n\n"));
  EXPECT_TRUE(contains(page.received, "Content-Type: text/event-stream\r\n"));
  EXPECT_TRUE(contains(page.received, "Cache-Control: no-store\r\n"));
  EXPECT_FALSE(contains(page.received, "data:")) << "the page has the first scene already";
  const uint64_t first = idOf(page.received);
  server.show("page", "{\"scene\":2}");
  ASSERT_TRUE(page.receives("data: {\"scene\":2}\n\n"));
  const uint64_t second = idOf(page.received);
  EXPECT_GT(second, first);
  EXPECT_TRUE(contains(page.received, "\n\nevent: scene\nid: " + std::to_string(second) + "\ndata: {\"scene\":2}\n\n"));
  server.fail("\"no triangles\"");
  ASSERT_TRUE(page.receives("data: \"no triangles\"\n\n"));
  const uint64_t third = idOf(page.received);
  EXPECT_GT(third, second);
  EXPECT_TRUE(contains(page.received, "\n\nevent: failure\nid: " + std::to_string(third) + "\ndata: \"no triangles\"\n\n"));
}

// What a page receives that connects after a scene 1 and the `later` ones, 's' and a number for a scene, 'f' and a number for a failure. It
// knows the first `known` of them, or is new.
std::string eventsAfter(const std::string& later, std::optional<int> known) {
  const std::unique_ptr<PageServer> server = openPageServer(0, kUnlimited);
  server->show("page", "1");
  Client open(*server, request(*server, "GET /events"));
  EXPECT_TRUE(open.receives("\n\n"));
  const uint64_t first = idOf(open.received);
  for (size_t i = 0; i < later.size(); i += 2)
    later[i] == 's' ? server->show("page", later.substr(i + 1, 1)) : server->fail(later.substr(i + 1, 1));
  Client back(*server, request(*server, "GET /events", known ? lastEventId(first + uint64_t(*known)) : ""));
  EXPECT_TRUE(back.receives("\n\n"));  // what it missed was looked up before this was sent
  server->show("page", "end");
  EXPECT_TRUE(back.receives("data: end\n\n"));
  const std::string events = bodyOf(back.received);
  return events.substr(0, events.rfind("event: scene"));
}

TEST(PageServer, APageThatComesBackReceivesWhatItMissed) {
  EXPECT_FALSE(contains(eventsAfter("", 0), "data:"));

  const std::string failure = eventsAfter("f2", 0);
  EXPECT_TRUE(contains(failure, "event: failure"));
  EXPECT_FALSE(contains(failure, "event: scene"));
  EXPECT_FALSE(contains(eventsAfter("f2", 1), "data:"));
  EXPECT_TRUE(contains(eventsAfter("f2", std::nullopt), "event: failure")) << "a new page shows the failure too";

  const std::string scene = eventsAfter("f2s3", 1);
  EXPECT_TRUE(contains(scene, "event: scene"));
  EXPECT_FALSE(contains(scene, "event: failure")) << "it is cured";
  EXPECT_FALSE(contains(eventsAfter("f2s3", 2), "data:"));
  const std::string fresh = eventsAfter("f2s3", std::nullopt);
  EXPECT_TRUE(contains(fresh, "event: scene")) << "a page that was read before the second scene may connect after it";
  EXPECT_FALSE(contains(fresh, "event: failure"));

  const std::string both = eventsAfter("s2s3f4", 0);
  EXPECT_TRUE(contains(both, "data: 3\n\nevent: failure"));
  EXPECT_FALSE(contains(both, "data: 2\n"));
}

TEST_F(PageServerTest, PagesOfAnEarlierServerReceiveTheScene) {
  for (const char* id : {"1", "0", "99999999999999999"}) {
    Client page(server, request(server, "GET /events", std::string("Last-Event-ID: ") + id + "\r\n"));
    EXPECT_TRUE(page.receives("event: scene")) << id;
  }
  std::deque<Client> pages;
  for (const char* id : {"", "x", "-1", "1x", "999999999999999999999999"})
    EXPECT_TRUE(pages.emplace_back(server, request(server, "GET /events", std::string("Last-Event-ID: ") + id + "\r\n")).receives("\n\n"))
        << id;
  server.show("page", "end");
  for (Client& page : pages) {
    EXPECT_TRUE(page.receives("data: end\n\n"));
    EXPECT_EQ(page.received.find("event:"), page.received.rfind("event:")) << "nothing came before: " << page.received;
  }
}

TEST(PageServer, KeepsQuietConnectionsAlive) {
  const std::unique_ptr<PageServer> server = openPageServer(0, {.keep_alive = milliseconds(50)});
  server->show("page", "1");
  Client page(*server, request(*server, "GET /events"));
  EXPECT_TRUE(page.receives("\n\n:\n\n:\n\n"));
}

// Nothing is sent to the pages that are closed: the server notices it by itself.
TEST_F(PageServerTest, PagesThatAreClosedMakeRoom) {
  constexpr int kMost = 32;
  for (int round = 0; round < 3; ++round) {
    std::deque<Client> pages;
    for (int i = 0; i < kMost; ++i)
      ASSERT_TRUE(comesTrue([&] {  // the pages of the round before have just been closed
        pages.emplace_back(server, request(server, "GET /events")).receives("\r\n\r\n");
        if (codeOf(pages.back().received) == "200") return true;
        pages.pop_back();
        return false;
      }));
    EXPECT_EQ(codeFor(server, "GET /events"), "503");
    EXPECT_EQ(codeFor(server, "GET /"), "200");
  }
}

// With an hour for a request, only what does not wait for them can answer.
TEST(PageServer, ClientsWithoutARequestDoNotStopIt) {
  const std::unique_ptr<PageServer> opened = openPageServer(0, {.request = std::chrono::hours(1)});
  PageServer& server = *opened;
  server.show("<p>first</p>", "1");
  std::deque<Client> silent, half;
  for (int i = 0; i < 300; ++i) silent.emplace_back(server);
  EXPECT_EQ(codeFor(server, "GET /"), "200");
  for (int i = 0; i < 600; ++i) half.emplace_back(server, "GET / HTTP/1.1\r\nHost");
  EXPECT_EQ(codeFor(server, "GET /"), "200");
  EXPECT_EQ(silent.front().all(), "") << "the oldest is closed for newer ones";
  half.front().all();
  Client& newest = half.back();  // and the newest is not
  newest.send(": " + hostOf(server) + "\r\n\r\n");
  EXPECT_EQ(bodyOf(newest.all()), "<p>first</p>");
}

TEST_F(PageServerTest, ManyAtOnceAreAllAnswered) {
  std::deque<Client> clients;
  for (int i = 0; i < 200; ++i) clients.emplace_back(server, request(server, "GET /"));
  for (Client& client : clients) EXPECT_EQ(bodyOf(client.all()), "<p>first</p>");
}

// A client that asks for much and reads nothing.
TEST_F(PageServerTest, OneThatDoesNotReadHarmsNobody) {
  server.show(std::string(50'000'000, 'x'), "2");
  std::deque<Client> lazy;
  for (int i = 0; i < 200; ++i) lazy.emplace_back(server, request(server, "GET /"));  // more than there are threads
  EXPECT_EQ(codeFor(server, "HEAD /"), "200");
  Client page(server, request(server, "GET /events"));
  EXPECT_TRUE(page.receives("event: scene"));
}

TEST_F(PageServerTest, ScenesDoNotPileUp) {
  Client page(server, request(server, "GET /events"));
  ASSERT_TRUE(page.receives("\n\n"));
  const size_t threads = threadCount(), handles = handleCount();
  for (int i = 0; i < 1000; ++i) {
    server.show("page", "\"scene " + std::to_string(i) + "\"");
    server.fail("\"failure " + std::to_string(i) + "\"");
    if (i % 100 == 0) Client(server, request(server, "GET /events")).receives("event: failure");
  }
  EXPECT_TRUE(page.receives("\"failure 999\""));
  EXPECT_TRUE(countsBecome(threads, handles)) << threadCount() << " " << handleCount();
}

// No connection ends by itself, or has anything to send.
TEST(PageServer, EndsWithItsConnections) {
  const size_t threads = threadCount(), handles = handleCount();
  auto server = openPageServer(0, kUnlimited);
  server->show(std::string(50'000'000, 'x'), "1");
  std::deque<Client> clients;
  for (int i = 0; i < 5; ++i) clients.emplace_back(*server);
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(clients.emplace_back(*server, request(*server, "GET /events")).receives("retry:"));
  for (int i = 0; i < 5; ++i) clients.emplace_back(*server, request(*server, "GET /"));
  alarm(unsigned(kHangs.count()));  // a signal ends the test if the server does not end
  server.reset();
  alarm(0);
  for (Client& client : clients) client.close();
  EXPECT_TRUE(countsBecome(threads, handles));
}

TEST(PageServer, EndsWithoutAPage) {
  const size_t threads = threadCount(), handles = handleCount();
  openPageServer(0, kUnlimited);
  openPageServer(0, kUnlimited)->show("page", "1");
  EXPECT_TRUE(countsBecome(threads, handles));
}

}  // namespace
}  // namespace cloudbake
