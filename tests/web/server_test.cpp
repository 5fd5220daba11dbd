#include "oraclegs/web/server.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>

#include "oraclegs/core/error.h"
#include "oraclegs/web/assets.h"
#include "support/errors.h"
#include "web/raw_client.h"

namespace oraclegs {
namespace {

using testing::AnyOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

class WebServerTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!WebPagesBuilt()) GTEST_SKIP() << "the pages were not built: " << HowToBuildWebPages();
    MakeSite(root);
    server = std::make_unique<WebServer>(WebServerOptions{}, ViewerOf(root));
    port = server->port();
  }

  TempDir temp;
  std::filesystem::path root = temp / "out";
  std::unique_ptr<WebServer> server;
  int port = 0;
};

TEST_F(WebServerTest, ServesPageDocumentsAndFiles) {
  EXPECT_EQ(server->url(), "http://127.0.0.1:" + std::to_string(port) + "/");
  const std::string page = Ask(port, "/");
  EXPECT_THAT(page, StartsWith("HTTP/1.1 200 "));
  EXPECT_THAT(page, HasSubstr("Content-Type: text/html"));
  EXPECT_THAT(page, HasSubstr("Content-Security-Policy: default-src 'self'"));
  EXPECT_EQ(BodyOf(page), FindWebAsset("viewer.html")->bytes);
  EXPECT_EQ(BodyOf(Ask(port, "/assets/viewer.js")), FindWebAsset("viewer.js")->bytes);
  EXPECT_THAT(Ask(port, "/api/document"), HasSubstr("application/json"));
  EXPECT_EQ(BodyOf(Ask(port, "/files/report/images/0.jpg")), "an image");
  EXPECT_EQ(BodyOf(Ask(port, "/files/report%2fimages/%30.jpg?x=1")), "an image") << "a query, and letters as codes";
}

TEST_F(WebServerTest, HeadHasNoBody) {
  const std::string head = Ask(port, "/files/report/images/0.jpg", "HEAD");
  EXPECT_THAT(head, StartsWith("HTTP/1.1 200 "));
  EXPECT_THAT(head, HasSubstr("Content-Length: 8"));
  EXPECT_EQ(BodyOf(head), "");
}

TEST_F(WebServerTest, SendsLargeFilesWhole) {
  std::string large(5'000'000, '\0');
  for (size_t i = 0; i < large.size(); ++i) large[i] = static_cast<char>(i * 2654435761u >> 13);
  WriteText(root / "live" / "splat.splat", large);
  EXPECT_EQ(BodyOf(Ask(port, "/files/live/splat.splat")), large);
  WriteText(root / "live" / "splat.splat", "");
  EXPECT_THAT(Ask(port, "/files/live/splat.splat"), StartsWith("HTTP/1.1 200 "));
}

TEST_F(WebServerTest, ATagSavesTheTransfer) {
  const std::string first = Ask(port, "/files/live/splat.splat");
  const size_t at = first.find("ETag: ");
  ASSERT_NE(at, std::string::npos);
  const std::string tag = first.substr(at + 6, first.find("\r\n", at) - at - 6);
  EXPECT_THAT(Ask(port, "/files/live/splat.splat", "GET", "If-None-Match: " + tag + "\r\n"),
              StartsWith("HTTP/1.1 304 "));
}

TEST_F(WebServerTest, NoWayLeadsOutOfTheFolder) {
  std::filesystem::create_symlink(temp / "secret.txt", root / "link.mp4");
  for (const char* target : {"/files/../secret.txt",
                             "/files/%2e%2e/secret.txt",
                             "/files/%2e%2e%2fsecret.txt",
                             "/files/..%2fsecret.txt",
                             "/files/%252e%252e/secret.txt",
                             "/files/..\\secret.txt",
                             "/files/..%5csecret.txt",
                             "/files//etc/passwd",
                             "/files/%2fetc%2fpasswd",
                             "/files/etc/passwd",
                             "/files/options.json",
                             "/files/options.json%00",
                             "/files/options.json%00.jpg",
                             "/files/report/images/../../options.json",
                             "/files/./report/images/0.jpg",
                             "/files/report//images/0.jpg",
                             "/files/link.mp4",
                             "/../secret.txt",
                             "/%2e%2e/secret.txt",
                             "/files/%c0%ae%c0%ae/secret.txt",
                             "/files/%u002e%u002e/secret.txt",
                             "/assets/../../secret.txt",
                             "/assets/%2e%2e/run.json",
                             "../secret.txt",
                             "http://127.0.0.1/files/options.json",
                             "/files/report/run.json",
                             "/options.json",
                             "/live/state.json"}) {
    const std::string answer = Ask(port, target);
    EXPECT_THAT(answer, AnyOf(StartsWith("HTTP/1.1 404 "), StartsWith("HTTP/1.1 400 "))) << target;
    EXPECT_THAT(answer, Not(AnyOf(HasSubstr("secret"), HasSubstr("private"), HasSubstr("root:")))) << target;
  }
}

TEST_F(WebServerTest, WritesNothing) {
  for (const char* method : {"POST", "PUT", "DELETE", "PATCH", "OPTIONS", "TRACE", "CONNECT"}) {
    const std::string answer = Ask(port, "/files/report/images/0.jpg", method, "Content-Length: 4\r\n");
    EXPECT_THAT(answer, StartsWith("HTTP/1.1 405 ")) << method;
    EXPECT_THAT(answer, HasSubstr("Allow: GET, HEAD"));
  }
  EXPECT_THAT(Ask(port, "/", "FROBNICATE"), StartsWith("HTTP/1.1 400 "));
  EXPECT_EQ(BodyOf(Ask(port, "/files/report/images/0.jpg")), "an image");
}

TEST_F(WebServerTest, OtherNamesAreRefused) {
  for (const char* host : {"evil.example", "127.0.0.1", "localhost:1", ""}) {
    const RawClient client(port);
    client.Send(std::string("GET /api/document HTTP/1.1\r\nHost: ") + host + "\r\nConnection: close\r\n\r\n");
    EXPECT_THAT(client.Receive(), AnyOf(StartsWith("HTTP/1.1 403 "), StartsWith("HTTP/1.1 400 "))) << host;
  }
  const RawClient without(port);
  without.Send("GET /api/document HTTP/1.0\r\n\r\n");
  EXPECT_THAT(without.Receive(), HasSubstr(" 403 "));
  EXPECT_THAT(Ask(port, "/api/document", "GET", "Host: evil.example\r\n"), StartsWith("HTTP/1.1 403 "));
}

TEST_F(WebServerTest, ATakenPortIsAnError) {
  EXPECT_THAT(MessageOf<UsageError>([&] {
                WebServer(WebServerOptions{"127.0.0.1", port}, ViewerOf(root));
              }),
              HasSubstr("--port " + std::to_string(port) + ": is in use"));
  const WebServer next({}, ViewerOf(root));
  EXPECT_NE(next.port(), port);
  EXPECT_THAT(Ask(next.port(), "/api/ping"), StartsWith("HTTP/1.1 200 "));
  EXPECT_THAT(MessageOf<UsageError>([&] { WebServer(WebServerOptions{"no.such.host.invalid"}, ViewerOf(root)); }),
              HasSubstr("--host"));
}

TEST_F(WebServerTest, EndsWhileClientsWait) {
  const RawClient idle(port), slow(port), reading(port);
  slow.Send("GET / HT");
  WriteText(root / "live" / "splat.splat", std::string(30'000'000, 'x'));
  reading.Send("GET /files/live/splat.splat HTTP/1.1\r\nHost: localhost:" + std::to_string(port) + "\r\n\r\n");
  server.reset();  // ends, though none of them has
  EXPECT_FALSE(RawClient(port).connected());
}

}  // namespace
}  // namespace oraclegs
