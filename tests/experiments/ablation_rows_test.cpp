#include "oraclegs/experiments/ablation_rows.h"

#include "pipeline/fixtures.h"

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

nlohmann::json Shaping(size_t row, const RunOptions& asked = {}) {
  return ShapingOptionsToJson(RowOptions(row, asked));
}

TEST(AblationRows, EachChangesSomething) {
  for (size_t row = 1; row < AblationRows().size(); ++row) {
    EXPECT_NE(Shaping(row), Shaping(row - 1)) << AblationRows()[row].name;
  }
}

TEST(AblationRows, TheLastIsTheProgramAsItIs) {
  const size_t last = AblationRows().size() - 1;
  EXPECT_EQ(Shaping(last), ShapingOptionsToJson(RunOptions{}));
  RunOptions asked;
  asked.split.views = 12;
  asked.start = {"hybrid", 0.7, 0.1, 0.5, "no", 3};
  asked.propose.proposers = "splat", asked.propose.proposal_folder = "/somewhere";
  asked.validate.pick = "pixel";
  asked.train.iterations = 100, asked.train.depth_weight = 2, asked.train.dropout = 0.1, asked.train.exposure = "on";
  asked.train.schedule = "constant", asked.train.coarse_share = 0.2, asked.train.prune_floaters = true;
  EXPECT_EQ(Shaping(last, asked), ShapingOptionsToJson(asked));
}

TEST(AblationRows, TheFirstIsMcmcAlone) {
  RunOptions asked;
  asked.split.views = 12, asked.train.iterations = 100, asked.start.seed = 4;
  asked.train.coarse_share = 0.3, asked.train.prune_floaters = true, asked.propose.proposal_folder = "/somewhere";
  const RunOptions first = RowOptions(0, asked);
  EXPECT_EQ(first.start.init, "random");
  EXPECT_EQ(first.propose.proposers, "none");
  EXPECT_TRUE(first.propose.proposal_folder.empty());
  const TrainOptions& t = first.train;
  EXPECT_EQ(t.depth_weight + t.alpha_weight + t.opacity_noise + t.dropout + t.coarse_share + t.proposal_lpips, 0);
  EXPECT_EQ(t.last_rates, 1);
  EXPECT_FALSE(t.prune_floaters);
  EXPECT_EQ(t.largest_scale, 0);
  EXPECT_EQ(t.exposure, "off");
  EXPECT_EQ(first.split.views, 12) << "what no row is about holds for all of them";
  EXPECT_EQ(t.iterations, 100);
  EXPECT_EQ(first.start.seed, 4u);
}

TEST(AblationRows, OnlyTheLastAsksLpips) {
  for (size_t row = 0; row < AblationRows().size(); ++row) {
    const double share = RowOptions(row, {}).train.proposal_lpips;
    EXPECT_EQ(share, row + 1 < AblationRows().size() ? 0 : TrainOptions().proposal_lpips) << AblationRows()[row].name;
  }
}

TEST(AblationRows, TheOracleIsCalibratedInARowOfItsOwn) {
  for (size_t row = 0; row < AblationRows().size(); ++row) {
    EXPECT_EQ(RowOptions(row, {}).validate.calibrate, row >= 8) << AblationRows()[row].name;
  }
}

TEST(AblationRows, APartSwitchedOffByTheUserStaysOff) {
  RunOptions asked;
  asked.train.depth_weight = 0;
  asked.train.schedule = "constant";
  EXPECT_EQ(Shaping(4, asked), Shaping(3, asked));
  EXPECT_EQ(Shaping(2, asked), Shaping(1, asked));
  asked.validate.oracle = "uniform";
  EXPECT_EQ(Shaping(5, asked), Shaping(4, asked)) << "nobody to trust";
  EXPECT_EQ(Shaping(8, asked), Shaping(7, asked)) << "nothing to calibrate";
  asked.propose.proposers = "none", asked.propose.proposal_folder = "/somewhere";
  EXPECT_EQ(RowOptions(1, asked).propose.proposers, "none");
  EXPECT_EQ(RowOptions(1, asked).propose.proposal_folder, "/somewhere");
}

TEST(ChooseRows, ByNumberAndName) {
  EXPECT_EQ(ChooseRows("").size(), AblationRows().size());
  EXPECT_THAT(ChooseRows("depth, 1,proposals,2"), ElementsAre(0, 1, 4));
  EXPECT_THAT(ChooseRows("lpips,9"), ElementsAre(8, 10));
  for (const char* bad : {"magic", "0", "12", "1,,2", "1,"}) {
    EXPECT_THAT(MessageOf<UsageError>([&] { ChooseRows(bad); }), AllOf(HasSubstr("--rows"), HasSubstr("5 depth")))
        << bad;
  }
}

TEST(RequireAblatable, RefusesOptionsThatContradictTheRows) {
  RequireAblatable({});
  RunOptions options;
  options.propose.proposers = "none";
  EXPECT_THAT(MessageOf<UsageError>([&] { RequireAblatable(options); }), HasSubstr("--proposers none"));
  options.propose.proposal_folder = "/somewhere";
  RequireAblatable(options);
  options.train.schedule = "none";
  EXPECT_THAT(MessageOf<UsageError>([&] { RequireAblatable(options); }), HasSubstr("--schedule none"));
  RunOptions blind;
  blind.depth.depth_prior = "none";
  EXPECT_THAT(MessageOf<UsageError>([&] { RequireAblatable(blind); }), HasSubstr("--depth-prior none"));
  for (const char* init : {"random", "sfm"}) {
    RunOptions other;
    other.start.init = init;
    EXPECT_THAT(MessageOf<UsageError>([&] { RequireAblatable(other); }), HasSubstr(std::string("--init ") + init));
  }
}

}  // namespace
}  // namespace oraclegs
