#include "oraclegs/web/assets.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace oraclegs
