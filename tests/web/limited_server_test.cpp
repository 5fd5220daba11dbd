#include "oraclegs/web/limited_server.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>
#include <vector>

#include "web/raw_client.h"

namespace oraclegs {
namespace {

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

}  // namespace
}  // namespace oraclegs
