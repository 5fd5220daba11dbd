#include "oraclegs/web/connection.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pthread.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstdio>
#include <fstream>
#include <memory>
#include <new>
#include <thread>
#include <vector>

#include "oraclegs/core/error.h"
#include "web/raw_client.h"

namespace oraclegs {
namespace {

class ConnectionTest : public testing::Test {
 protected:
  ConnectionTest() { EXPECT_EQ(socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()), 0); }
  ~ConnectionTest() override { close(ends[1]); }

  std::array<int, 2> ends{};
  std::atomic<bool> stopping = false;
};

TEST_F(ConnectionTest, ReadsAndWrites) {
  Connection connection(ends[0], stopping);
  ASSERT_EQ(write(ends[1], "hello", 5), 5);
  ASSERT_TRUE(connection.WaitForRequest());
  std::array<char, 16> text{};
  EXPECT_EQ(connection.read(text.data(), 3), 3);
  EXPECT_EQ(connection.read(text.data() + 3, 10), 2);
  EXPECT_STREQ(text.data(), "hello");
  EXPECT_EQ(connection.write("you", 3), 3);
  EXPECT_EQ(read(ends[1], text.data(), 16), 3);
  shutdown(ends[1], SHUT_RDWR);
}

TEST_F(ConnectionTest, ARequestHasAtMost8Kilobytes) {
  Connection connection(ends[0], stopping);
  const std::string endless(20'000, 'x');
  ASSERT_GT(write(ends[1], endless.data(), endless.size()), 0);
  ASSERT_TRUE(connection.WaitForRequest());
  size_t total = 0;
  std::array<char, 1000> part;
  for (ssize_t n; (n = connection.read(part.data(), part.size())) > 0;) total += static_cast<size_t>(n);
  EXPECT_EQ(total, 8192u);
  shutdown(ends[1], SHUT_RDWR);
}

TEST_F(ConnectionTest, AStopEndsItsWaits) {
  Connection connection(ends[0], stopping);
  stopping = true;
  EXPECT_FALSE(connection.WaitForRequest());
}

TEST_F(ConnectionTest, AClosedEndIsNoRequest) {
  Connection connection(ends[0], stopping);
  shutdown(ends[1], SHUT_RDWR);
  char byte = 0;
  EXPECT_TRUE(!connection.WaitForRequest() || connection.read(&byte, 1) <= 0);
}

using testing::HasSubstr;

/// Answers every request with its method and path.
class LimitedServerTest : public testing::Test {
 protected:
  LimitedServerTest() {
    server.set_pre_routing_handler([](const httplib::Request& request, httplib::Response& response) {
      response.status = request.ranges.empty() ? 200 : 206;
      response.set_content(request.method + " " + request.path, "text/plain");
      return httplib::Server::HandlerResponse::Handled;
    });
    port = server.bind_to_any_port("127.0.0.1");
    thread = std::thread([this] { server.listen_after_bind(); });
    while (!server.is_running()) std::this_thread::yield();
  }
  ~LimitedServerTest() override {
    server.StopConnections();
    server.stop();
    thread.join();
  }
  std::string Raw(const std::string& bytes) const {
    const RawClient client(port);
    client.Send(bytes);
    return client.Receive();
  }

  LimitedServer server;
  int port = 0;
  std::thread thread;
};

TEST_F(LimitedServerTest, AnswersRequestsOfOneConnection) {
  const RawClient client(port);
  for (const char* path : {"/a", "/b"}) {
    client.Send(std::string("GET ") + path + " HTTP/1.1\r\nHost: x\r\n\r\n");
    EXPECT_EQ(BodyOf(client.Receive()), std::string("GET ") + path);
  }
}

TEST_F(LimitedServerTest, NothingFollowsABody) {
  // The body is no second request.
  const std::string smuggled = "GET /second HTTP/1.1\r\nHost: x\r\n\r\n";
  for (const std::string& head : {std::string("POST / HTTP/1.1\r\nHost: x\r\nContent-Length: 100\r\n\r\n"),
                                  std::string("GET / HTTP/1.1\r\nHost: x\r\nContent-Length: 5\r\n\r\n"),
                                  std::string("GET / HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\n\r\n"),
                                  std::string("nonsense\r\n\r\n"), std::string("\x16\x03\x01\r\n\r\n")}) {
    const RawClient client(port);
    client.Send(head + smuggled);
    std::string all = client.Receive();
    for (std::string more = client.Receive(); !more.empty(); more = client.Receive()) all += more;
    EXPECT_THAT(all, testing::Not(HasSubstr("/second"))) << head;
  }
}

TEST_F(LimitedServerTest, RangesAreIgnored) {
  std::string ranges = "0-0";
  for (int i = 0; i < 1500; ++i) ranges += ",0-0";
  const std::string answer = Raw("GET /r HTTP/1.1\r\nHost: x\r\nRange: bytes=" + ranges + "\r\n\r\n");
  EXPECT_EQ(answer.find("multipart"), std::string::npos);
  EXPECT_EQ(BodyOf(Raw("GET /r HTTP/1.1\r\nHost: x\r\nRange: bytes=0-1\r\n\r\n")), "GET /r");
}

TEST_F(LimitedServerTest, NothingIsCompressedWhileSomebodyWaits) {
  const std::string answer =
      Raw("GET /c HTTP/1.1\r\nHost: x\r\nAccept-Encoding: gzip, br\r\nConnection: close\r\n\r\n");
  EXPECT_EQ(answer.find("Content-Encoding"), std::string::npos);
  EXPECT_EQ(BodyOf(answer), "GET /c");
}

TEST_F(LimitedServerTest, LongRequestsAreRefused) {
  const std::string a_line = Raw("GET /" + std::string(9000, 'a') + " HTTP/1.1\r\nHost: x\r\n\r\n");
  EXPECT_THAT(a_line, testing::Not(HasSubstr("200 OK")));
  std::string many = "GET / HTTP/1.1\r\nHost: x\r\n";
  for (int i = 0; i < 5000; ++i) many += "X-" + std::to_string(i) + ": y\r\n";
  EXPECT_THAT(Raw(many + "\r\n"), testing::Not(HasSubstr("200 OK")));
  EXPECT_EQ(BodyOf(Raw("GET /still HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n")), "GET /still");
}

TEST_F(LimitedServerTest, SlowClientsDisturbNobody) {
  std::vector<std::unique_ptr<RawClient>> slow;
  for (int i = 0; i < 40; ++i) {
    slow.push_back(std::make_unique<RawClient>(port));
    slow.back()->Send("GET /slow HTTP/1.1\r\nHo");
  }
  EXPECT_EQ(BodyOf(Raw("GET /quick HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n")), "GET /quick");
}

TEST_F(LimitedServerTest, TooManyConnectionsAreTurnedAwayAndForgotten) {
  {
    std::vector<std::unique_ptr<RawClient>> crowd;
    for (int i = 0; i < 160; ++i) crowd.push_back(std::make_unique<RawClient>(port));
    for (const auto& client : crowd) client->Send("GET /c HTTP/1.1\r\nHo");
    EXPECT_THAT(crowd.back()->Receive(), testing::Not(HasSubstr("200")));
  }
  EXPECT_EQ(BodyOf(Raw("GET /after HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n")), "GET /after");
}

/// Limits the additional memory of this process, the stacks of threads included.
void LeaveRoomOf(rlim_t bytes) {
  std::ifstream status("/proc/self/statm");
  rlim_t pages = 0;
  status >> pages;
  const rlim_t all = pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE)) + bytes;
  const rlimit limit = {all, all};
  setrlimit(RLIMIT_AS, &limit);
}

/// Gives threads from now on stacks of this size.
void SetStackSize(size_t bytes) {
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_setstacksize(&attributes, bytes);
  pthread_setattr_default_np(&attributes);
  pthread_attr_destroy(&attributes);
}

/// Ends the process: with 0 when many simultaneous clients are answered by the few threads that fit into memory.
[[noreturn]] void ServeWithLittleRoom() {
  LimitedServer server;
  server.set_pre_routing_handler([](const httplib::Request&, httplib::Response& response) {
    response.set_content("here", "text/plain");
    return httplib::Server::HandlerResponse::Handled;
  });
  const int port = server.bind_to_any_port("127.0.0.1");
  std::thread thread([&] { server.listen_after_bind(); });
  while (!server.is_running()) std::this_thread::yield();
  constexpr rlim_t kStack = rlim_t{32} << 20;  // large beside all else, so that it is a stack that does not fit
  SetStackSize(kStack);
  LeaveRoomOf(3 * kStack + kStack / 2);
  std::vector<std::unique_ptr<RawClient>> clients;
  for (int i = 0; i < 40; ++i) {
    clients.push_back(std::make_unique<RawClient>(port));
    clients.back()->Send("GET / HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n");
  }
  int answered = 0;
  for (const auto& client : clients) answered += BodyOf(client->Receive()) == "here" ? 1 : 0;
  _exit(answered == 40 ? 0 : 1);
}

TEST(LimitedServer, GoesOnWithTheThreadsThatTheSystemGives) {
#ifdef __SANITIZE_THREAD__
  GTEST_SKIP() << "the thread sanitizer needs memory of its own for each thread, which the limit may refuse";
#endif
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(ServeWithLittleRoom(), testing::ExitedWithCode(0), "");
}

[[noreturn]] void StartWithoutRoom() {
  LeaveRoomOf(rlim_t{1} << 20);
  try {
    const LimitedServer server;
  } catch (const RunError& error) {
    std::fputs(error.what(), stderr);
    _exit(7);
  }
  _exit(0);
}

TEST(LimitedServer, SaysThatThereIsNoThread) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(StartWithoutRoom(), testing::ExitedWithCode(7), "cannot start a thread: .*ulimit");
}

TEST_F(LimitedServerTest, AConnectionThatFailsEndsAlone) {
  server.set_pre_routing_handler([](const httplib::Request& request, httplib::Response& response) {
    if (request.path == "/bad") throw std::bad_alloc();
    response.set_content("good", "text/plain");
    return httplib::Server::HandlerResponse::Handled;
  });
  Raw("GET /bad HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n");
  EXPECT_EQ(BodyOf(Raw("GET /good HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n")), "good");
}

}  // namespace
}  // namespace oraclegs
