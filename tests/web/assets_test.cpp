#include "oraclegs/web/assets.h"
#include "oraclegs/core/error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace oraclegs {
namespace {

using testing::HasSubstr;

TEST(WebAssets, AllOrNone) {
  for (const char* name : {"viewer.html", "viewer.js", "viewer.css", "report.html", "report.js", "report.css"}) {
    const std::optional<WebAsset> asset = FindWebAsset(name);
    ASSERT_EQ(asset.has_value(), WebPagesBuilt()) << name;
    EXPECT_NE(asset && asset->bytes.empty(), true) << name;
  }
}

TEST(WebAssets, HaveTheirTypes) {
  if (!WebPagesBuilt()) GTEST_SKIP() << "built without the web pages: " << HowToBuildWebPages();
  EXPECT_EQ(FindWebAsset("viewer.html")->type, "text/html; charset=utf-8");
  EXPECT_EQ(FindWebAsset("viewer.js")->type, "text/javascript; charset=utf-8");
  EXPECT_EQ(FindWebAsset("report.css")->type, "text/css; charset=utf-8");
  EXPECT_THAT(std::string(FindWebAsset("viewer.html")->bytes), HasSubstr("viewer.js"));
}

TEST(WebAssets, UnknownNamesAreNotThere) {
  for (const char* name : {"", "viewer", "../web/viewer.html", "/viewer.html", "viewer.html ", "pages.o"}) {
    EXPECT_FALSE(FindWebAsset(name)) << name;
  }
}

/// Text between the document's tags; "no document" without them.
std::string DocumentOf(const std::string& page) {
  const std::string open = "<script type=\"application/json\" id=\"document\">";
  const size_t begin = page.find(open);
  if (begin == std::string::npos) return "no document";
  return page.substr(begin + open.size(), page.find("</script>", begin) - begin - open.size());
}

class SelfContainedPageTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!WebPagesBuilt()) GTEST_SKIP() << "built without the web pages: " << HowToBuildWebPages();
  }
};

TEST_F(SelfContainedPageTest, HoldsTheDocumentUnchanged) {
  const nlohmann::json document = {{"title", "fox"}, {"scores", {{"psnr", 27.5}}}};
  EXPECT_EQ(nlohmann::json::parse(DocumentOf(SelfContainedPage(document))), document);
}

TEST_F(SelfContainedPageTest, NoTextEndsItsElement) {
  const nlohmann::json document = {{"title", "</script><script>alert(1)</script><!-- <script>"}};
  const std::string text = DocumentOf(SelfContainedPage(document));
  EXPECT_EQ(text.find('<'), std::string::npos);
  EXPECT_EQ(nlohmann::json::parse(text), document);
}

TEST_F(SelfContainedPageTest, MarkersInTheDocumentStay) {
  const nlohmann::json document = {{"title", "/*SCRIPT*/ /*STYLE*/ {\"DOCUMENT\":0}"}};
  EXPECT_EQ(nlohmann::json::parse(DocumentOf(SelfContainedPage(document))), document);
}

TEST_F(SelfContainedPageTest, ReplacesInvalidUtf8) {
  const nlohmann::json document = {{"title", "photo \xff"}};
  EXPECT_EQ(nlohmann::json::parse(DocumentOf(SelfContainedPage(document)))["title"], "photo \uFFFD");
}

TEST_F(SelfContainedPageTest, AsksForNoOtherFile) {
  const std::string page = SelfContainedPage(nlohmann::json::object());
  EXPECT_EQ(page.find("<link"), std::string::npos);
  EXPECT_EQ(page.find("<script src"), std::string::npos);
  EXPECT_EQ(page.find("/*STYLE*/"), std::string::npos);
  EXPECT_EQ(page.find("/*SCRIPT*/"), std::string::npos);
}

TEST(SelfContainedPage, SaysHowToBuildWherePagesAreMissing) {
  if (WebPagesBuilt()) {
    EXPECT_NO_THROW(SelfContainedPage(nlohmann::json::object()));
  } else {
    EXPECT_THROW(SelfContainedPage(nlohmann::json::object()), RunError);
  }
}

}  // namespace

}  // namespace oraclegs
