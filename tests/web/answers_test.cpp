#include "oraclegs/web/answers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "oraclegs/web/site.h"
#include "web/raw_client.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;

TEST(JsonAnswer, IsNotSentTwice) {
  const WebAnswer answer = JsonAnswer("{}", "");
  EXPECT_EQ(answer.status, 200);
  EXPECT_EQ(answer.body, "{}");
  EXPECT_EQ(answer.type, "application/json");
  const WebAnswer again = JsonAnswer("{}", answer.headers.at("ETag"));
  EXPECT_EQ(again.status, 304);
  EXPECT_EQ(again.body, "");
  EXPECT_EQ(JsonAnswer("{1}", answer.headers.at("ETag")).status, 200);
}

TEST(FileAnswer, IsNeverAPageOrAScript) {
  const TempDir dir;
  for (const char* name : {"a.html", "a.js", "a.svg", "a"}) {
    WriteText(dir / name, "text");
    EXPECT_EQ(FileAnswer(FileBelow::Open(dir.path(), name), name, "").type, "application/octet-stream") << name;
  }
  WriteText(dir / "a.PNG", "image");
  EXPECT_EQ(FileAnswer(FileBelow::Open(dir.path(), "a.PNG"), "a.PNG", "").type, "image/png");
  EXPECT_EQ(FileAnswer(std::nullopt, "a.png", "").status, 404);
}

TEST(SiteAnswer, IsTheSameBelowAnyAddress) {
  const TempDir dir;
  MakeSite(dir / "out");
  Site site(dir / "out");
  EXPECT_EQ(SiteAnswer("/api/ping", "", &site).body, "oraclegs\n");
  EXPECT_EQ(SiteAnswer("/files/report/images/0.jpg", "", &site).file.value().ReadAll(100), "an image");
  EXPECT_EQ(SiteAnswer("/files/options.json", "", &site).status, 404);
  EXPECT_EQ(SiteAnswer("/", "", &site).status, 404);
}

TEST(Restricted, SaysWhoMayFrameIt) {
  const WebAnswer nobody = Restricted(PlainAnswer(200, "x"), Frames::kNobody);
  EXPECT_THAT(nobody.headers.at("Content-Security-Policy"), HasSubstr("frame-ancestors 'none'"));
  EXPECT_EQ(nobody.headers.at("X-Frame-Options"), "DENY");
  const WebAnswer own = Restricted(PlainAnswer(200, "x"), Frames::kThisServer);
  EXPECT_THAT(own.headers.at("Content-Security-Policy"), HasSubstr("frame-ancestors 'self'"));
  EXPECT_EQ(own.headers.at("X-Frame-Options"), "SAMEORIGIN");
  WebAnswer strict = PlainAnswer(200, "x");
  strict.headers["Content-Security-Policy"] = "sandbox";
  EXPECT_EQ(Restricted(std::move(strict), Frames::kThisServer).headers.at("Content-Security-Policy"), "sandbox");
}

TEST(PathAfter, TakesAPrefixAway) {
  EXPECT_EQ(PathAfter("/files/a/b", "/files/"), "a/b");
  EXPECT_EQ(PathAfter("/files", "/files/"), std::nullopt);
}

}  // namespace
}  // namespace oraclegs
