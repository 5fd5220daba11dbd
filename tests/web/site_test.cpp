#include "oraclegs/web/site.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "oraclegs/core/folder_lock.h"
#include "web/raw_client.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

class SiteTest : public testing::Test {
 protected:
  SiteTest() { MakeSite(root); }

  nlohmann::json Live() { return nlohmann::json::parse(site.Live().value().json); }
  void WriteState(const std::string& text) { WriteText(root / "live" / "state.json", text); }
  void WriteDocument(const std::string& text) { WriteText(root / "report" / "run.json", text); }

  TempDir temp;
  fs::path root = temp / "out";
  Site site{root};
};

TEST(UrlsOf, FindsPlainPathsAnywhere) {
  const auto json = nlohmann::json::parse(
      R"([{"url": "a/b"}, {"x": [{"url": "c"}, {"url": 3}]}, {"url": "/etc/passwd"}, {"url": "data:,x//"}, {"name": "d"}])");
  EXPECT_THAT(UrlsOf(json), testing::ElementsAre("a/b", "c"));
}

TEST_F(SiteTest, GivesFilesThatADocumentNames) {
  EXPECT_TRUE(site.File("report/images/0.jpg"));
  EXPECT_TRUE(site.File("live/splat.splat"));
  for (const char* path : {"options.json", "../secret.txt", "report/run.json", "", "link.mp4"}) {
    EXPECT_FALSE(site.File(path)) << path;
  }
  fs::create_symlink(temp / "secret.txt", root / "link.mp4");
  EXPECT_FALSE(site.File("link.mp4")) << "a link out of the folder";
}

TEST_F(SiteTest, DamagedDocumentsLeaveTheLastWholeOne) {
  const auto whole = site.Document();
  ASSERT_TRUE(whole);
  for (const std::string& damaged :
       {std::string("{\"format\": 1, \"vie"), std::string(), std::string("[1, 2]"), std::string("\xff\xfe\x00", 3),
        "{\"a\":" + std::string(100'000, '[') + std::string(100'000, ']') + "}"}) {
    WriteDocument(damaged);
    ASSERT_TRUE(site.Document());
    EXPECT_EQ(site.Document()->json, whole->json);
    EXPECT_TRUE(site.File("report/images/0.jpg"));
  }
  WriteDocument(R"({"title": "new"})");
  EXPECT_EQ(site.Document()->json, R"({"title": "new"})");
  EXPECT_NE(site.Document()->tag, whole->tag);
  EXPECT_FALSE(site.File("report/images/0.jpg"));
}

TEST_F(SiteTest, WhatIsRemovedIsGone) {
  ASSERT_TRUE(site.Document() && site.Live());
  fs::remove_all(root / "report");
  fs::remove_all(root / "live");
  EXPECT_FALSE(site.Document());
  EXPECT_FALSE(site.Live());
  Site never(temp / "missing");
  EXPECT_FALSE(never.Document() || never.Live() || never.File("a"));
}

TEST_F(SiteTest, DocumentsThatAreLinksAreNotRead) {
  WriteText(temp / "other.json", R"({"secret": 1})");
  fs::remove(root / "report" / "run.json");
  fs::create_symlink(temp / "other.json", root / "report" / "run.json");
  EXPECT_FALSE(site.Document());
}

TEST_F(SiteTest, TheRevisionRisesWithTheDocument) {
  const int before = Live().at("document_revision");
  EXPECT_EQ(Live().at("document"), true);
  EXPECT_EQ(Live().at("document_revision"), before);
  WriteDocument(R"({"title": "another"})");
  EXPECT_EQ(Live().at("document_revision"), before + 1);
  fs::remove(root / "report" / "run.json");
  EXPECT_EQ(Live().at("document"), false);
}

TEST_F(SiteTest, AKilledRunIsKnownByItsLock) {
  WriteState(R"({"state": "running", "lock": true})");
  {
    const FolderLock lock(root / "live");
    EXPECT_EQ(Live().at("state"), "running");
  }
  EXPECT_EQ(Live().at("state"), "interrupted");
  EXPECT_THAT(Live().at("message").get<std::string>(), testing::HasSubstr("ended from outside"));
  WriteState(R"({"state": "running", "lock": false})");
  EXPECT_EQ(Live().at("state"), "running") << "a file system without locks";
  WriteState(R"({"state": 7, "lock": "x"})");
  EXPECT_EQ(Live().at("state"), 7);
}

}  // namespace
}  // namespace oraclegs
