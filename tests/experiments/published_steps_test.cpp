#include "oraclegs/experiments/published_steps.h"

#include <gmock/gmock.h>

#include "experiments/paper_tables.h"
#include "oraclegs/experiments/bench/suites.h"

namespace oraclegs {
namespace {

TEST(PublishedSteps, HasEachNumberOfTheTableAsPrinted) {
  const auto table = PaperTable("## Table 3");
  for (const size_t column : {1u, 2u}) {
    const std::vector<PublishedStep> steps = PublishedSteps(column == 1 ? 12 : 24);
    ASSERT_EQ(steps.size(), table.size());
    for (size_t r = 0; r < steps.size(); ++r) {
      const bool is_misprint = steps[r].psnr.ends_with('*');
      EXPECT_EQ(is_misprint, table[r][column].find("misprint") != std::string::npos);
      EXPECT_EQ((std::vector{std::stod(steps[r].psnr), steps[r].ssim, steps[r].lpips}), Numbers(table[r][column]));
    }
  }
  EXPECT_TRUE(PublishedSteps(9).empty());
}

TEST(ViewsOfPublishedSteps, AreOfThePapersImagesAlone) {
  RunOptions options;
  options.split.test_every = 8, options.split.views = 24;
  options.image.downscale = 4, options.image.smaller_copies = SmallerCopies::kRequired;
  EXPECT_EQ(ViewsOfPublishedSteps("garden", options), 24);
  EXPECT_EQ(ViewsOfPublishedSteps("fox", options), 0);
  RunOptions other = options;
  other.split.views = 9;
  EXPECT_EQ(ViewsOfPublishedSteps("garden", other), 0);
  other = options;
  other.image.downscale = 8;
  EXPECT_EQ(ViewsOfPublishedSteps("garden", other), 0);
  other = options;
  other.split.train_views = "0-40";
  EXPECT_EQ(ViewsOfPublishedSteps("garden", other), 0);
}

TEST(AreScenesOfPublishedSteps, AreAllSeven) {
  EXPECT_TRUE(AreScenesOfPublishedSteps({"room", "bicycle", "bonsai", "counter", "garden", "kitchen", "stump"}));
  EXPECT_TRUE(AreScenesOfPublishedSteps(FindSuite("mipnerf360").scenes)) << "those of the suite";
  EXPECT_FALSE(AreScenesOfPublishedSteps({"bicycle", "bonsai"}));
}

}  // namespace
}  // namespace oraclegs
