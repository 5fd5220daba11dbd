#include "oraclegs/web/routes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "web/raw_client.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;

class RoutesTest : public testing::Test {
 protected:
  RoutesTest() { MakeSite(root); }

  WebAnswer Get(const std::string& path, const std::string& known_tag = "") {
    return AnswerTo({"GET", path, "127.0.0.1:7860", 1, known_tag}, hosts, &site);
  }

  TempDir temp;
  std::filesystem::path root = temp / "out";
  Site site{root};
  AllowedHosts hosts{"127.0.0.1", 7860};
};

TEST_F(RoutesTest, AnswersWhatThereIs) {
  EXPECT_EQ(Get("/api/ping").status, 200);
  EXPECT_THAT(Get("/api/document").body, HasSubstr("report/images/0.jpg"));
  EXPECT_THAT(Get("/api/live").body, HasSubstr("finished"));
  const WebAnswer image = Get("/files/report/images/0.jpg");
  EXPECT_EQ(image.status, 200);
  EXPECT_EQ(image.type, "image/jpeg");
  EXPECT_EQ(image.file.value().ReadAll(100), "an image");
  EXPECT_EQ(Get("/files/live/splat.splat").type, "application/octet-stream");
}

TEST_F(RoutesTest, NothingElse) {
  for (const char* path : {"/files/options.json", "/files/../secret.txt", "/files//etc/passwd", "/files/", "/assets/",
                           "/assets/../viewer.html", "/assets/report.html", "/assets/nothing.js", "/index.html", "",
                           "/api", "/api/document/", "/files/report", "//api/ping", "http://127.0.0.1/api/ping"}) {
    EXPECT_EQ(Get(path).status, 404) << path;
  }
}

TEST_F(RoutesTest, NoContentWithoutDocuments) {
  Site empty(temp / "empty");
  for (const char* path : {"/api/document", "/api/live"}) {
    EXPECT_EQ(AnswerTo({"GET", path, "localhost:7860", 1, ""}, hosts, &empty).status, 204);
  }
}

TEST_F(RoutesTest, OnlyReads) {
  for (const char* method : {"POST", "PUT", "DELETE", "PATCH", "OPTIONS", "TRACE", "CONNECT", ""}) {
    const WebAnswer answer = AnswerTo({method, "/api/ping", "localhost:7860", 1, ""}, hosts, &site);
    EXPECT_EQ(answer.status, 405) << method;
    EXPECT_EQ(answer.headers.at("Allow"), "GET, HEAD");
  }
}

TEST_F(RoutesTest, AnswersToItsOwnNamesOnly) {
  for (const char* host : {"localhost:7860", "127.0.0.1:7860", "[::1]:7860", "LOCALHOST:7860"}) {
    EXPECT_TRUE(hosts.Allows(host)) << host;
  }
  for (const char* host :
       {"", "localhost", "localhost:80", "evil.example:7860", "localhost.evil.example:7860",
        "127.0.0.1.evil.example:7860", "10.0.0.5:7860", "0.0.0.0:7860", "localhost:7860:7860", "[::1]",
        "[::1]evil:7860", "localhost:", ":7860", "evil@localhost:7860", "127.0.0.1 :7860"}) {
    EXPECT_FALSE(hosts.Allows(host)) << host;
    EXPECT_EQ(AnswerTo({"GET", "/api/ping", host, 1, ""}, hosts, &site).status, 403) << host;
  }
  EXPECT_EQ(AnswerTo({"GET", "/api/ping", "localhost:7860", 2, ""}, hosts, &site).status, 403) << "two Host headers";
}

TEST(AllowedHosts, OfAnotherAddress) {
  const AllowedHosts named("10.0.0.5", 9000), everywhere("0.0.0.0", 9000), web("127.0.0.1", 80);
  EXPECT_TRUE(named.Allows("10.0.0.5:9000"));
  EXPECT_TRUE(named.Allows("localhost:9000"));
  EXPECT_FALSE(named.Allows("10.0.0.6:9000"));
  EXPECT_TRUE(everywhere.Allows("10.0.0.6:9000")) << "an address is no name that somebody else could direct here";
  EXPECT_FALSE(everywhere.Allows("evil.example:9000"));
  EXPECT_TRUE(web.Allows("localhost"));
}

TEST(AllowedHosts, KnowsWhoCanBeReachedFromOutside) {
  EXPECT_TRUE(IsLoopback("127.0.0.1") && IsLoopback("localhost") && IsLoopback("[::1]") && IsLoopback("127.0.0.9"));
  EXPECT_FALSE(IsLoopback("0.0.0.0") || IsLoopback("10.0.0.1") || IsLoopback("127.evil.example"));
  EXPECT_TRUE(IsWildcard("0.0.0.0") && IsWildcard("[::]") && IsWildcard(""));
  EXPECT_FALSE(IsWildcard("127.0.0.1"));
}

TEST_F(RoutesTest, EachAnswerKeepsBrowsersInBounds) {
  for (const char* path : {"/", "/api/ping", "/api/live", "/files/live/splat.splat", "/nothing"}) {
    const auto headers = Get(path).headers;
    EXPECT_THAT(headers.at("Content-Security-Policy"), HasSubstr("default-src 'self'"));
    EXPECT_THAT(headers.at("Content-Security-Policy"), HasSubstr("frame-ancestors 'none'"));
    EXPECT_EQ(headers.at("X-Content-Type-Options"), "nosniff");
    EXPECT_EQ(headers.at("Referrer-Policy"), "no-referrer");
    EXPECT_EQ(headers.at("Cross-Origin-Resource-Policy"), "same-origin");
    EXPECT_EQ(headers.at("Cache-Control"), "no-cache");
  }
}

TEST_F(RoutesTest, WhatHasNotChangedIsNotSentAgain) {
  for (const char* path : {"/api/document", "/files/live/splat.splat"}) {
    const std::string tag = Get(path).headers.at("ETag");
    const WebAnswer again = Get(path, tag);
    EXPECT_EQ(again.status, 304);
    EXPECT_TRUE(again.body.empty() && !again.file);
  }
  const std::string tag = Get("/files/live/splat.splat").headers.at("ETag");
  WriteText(root / "live" / "splat.splat", std::string(96, 't'));
  EXPECT_EQ(Get("/files/live/splat.splat", tag).status, 200);
}

}  // namespace
}  // namespace oraclegs
