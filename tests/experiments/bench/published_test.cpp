#include "oraclegs/experiments/bench/published.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <set>

#include "experiments/paper_tables.h"

namespace oraclegs {
namespace {

TEST(PublishedFor, HasEachMethodOnceWithItsSource) {
  for (const auto& [suite, views, count] : {std::tuple{"mipnerf360", 12, 11u},
                                            {"mipnerf360", 24, 13u},
                                            {"blender", 8, 12u},
                                            {"llff", 3, 10u},
                                            {"llff", 6, 9u},
                                            {"llff", 9, 9u},
                                            {"dtu", 3, 7u},
                                            {"dtu", 9, 6u}}) {
    std::set<std::string> methods;
    const std::vector<PublishedScore> scores = PublishedFor(suite, views);
    for (const PublishedScore& score : scores) {
      methods.insert(score.method);
      EXPECT_THAT(score.source, testing::ContainsRegex("^\\[[A-Z][a-z]+ 20[0-9]+\\], table"));
      ASSERT_TRUE(score.psnr);
      EXPECT_TRUE(*score.psnr > 9 && *score.psnr < 28) << score.label;
      ASSERT_EQ(score.ssim.has_value(), score.lpips.has_value());
      if (!score.ssim) continue;
      EXPECT_TRUE(*score.ssim > 0.3 && *score.ssim < 1 && *score.lpips > 0 && *score.lpips < 0.62) << score.label;
    }
    EXPECT_EQ(methods.size(), count) << suite << views;
    EXPECT_EQ(scores.size(), count) << suite << views;
  }
}

TEST(PublishedFor, HasEachNumberOfThePaperAsPrinted) {
  int numbers = 0;
  const auto compare = [&](const std::string& suite, int views, std::string label, const std::string& cell) {
    label = label.substr(0, label.find(" ("));
    if (label == "Ours") label = "OracleGS (paper)";
    const std::vector<PublishedScore> scores = PublishedFor(suite, views);
    const auto score =
        std::find_if(scores.begin(), scores.end(), [&](const PublishedScore& s) { return s.label == label; });
    ASSERT_NE(score, scores.end()) << label;
    EXPECT_THAT(score->source, testing::HasSubstr("Topaloglu"));
    EXPECT_EQ((std::vector{*score->psnr, *score->ssim, *score->lpips}), Numbers(cell)) << label << views;
    numbers += 3;
  };
  for (const auto& row : PaperTable("## Table 1")) {
    compare("mipnerf360", 12, row.at(0), row.at(1));
    compare("mipnerf360", 24, row.at(0), row.at(2));
  }
  for (const auto& row : PaperTable("## Table 2")) compare("blender", 8, row.at(0), row.at(1));
  EXPECT_EQ(numbers, 66 + 27);
}

TEST(PublishedFor, HasTheMethodsForRadianceFields) {
  for (const auto& [suite, views] : {std::pair{"mipnerf360", 24}, {"blender", 8}, {"llff", 3}, {"dtu", 3}}) {
    std::vector<std::string> labels;
    for (const PublishedScore& score : PublishedFor(suite, views)) labels.push_back(score.label);
    EXPECT_THAT(labels, testing::IsSupersetOf({"RegNeRF", "FreeNeRF", "SparseNeRF"})) << suite;
  }
}

TEST(PublishedFor, TakesTheColumnOfTheViews) {
  const std::vector<PublishedScore> scores = PublishedFor("llff", 6);
  const auto score =
      std::find_if(scores.begin(), scores.end(), [](const PublishedScore& s) { return s.method == "cor-gs"; });
  ASSERT_NE(score, scores.end());
  EXPECT_EQ(score->psnr, 24.49);
  EXPECT_EQ(score->ssim, 0.837);
  EXPECT_EQ(score->lpips, 0.115);
}

TEST(PublishedFor, HasNoneOfOtherProtocols) {
  EXPECT_TRUE(PublishedFor("mipnerf360", 6).empty());
  EXPECT_TRUE(PublishedFor("llff", 12).empty());
}

}  // namespace
}  // namespace oraclegs
