#include "oraclegs/experiments/ablation_rows.h"

#include "pipeline/fixtures.h"
#include "support/errors.h"

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

nlohmann::json Shaping(size_t row, const RunOptions& asked = {}) {
  return ShapingOptionsToJson(RowOptions(row, asked));
}

TEST(AblationRows, ChangeSomethingEach) {
  for (size_t row = 1; row < AblationRows().size(); ++row) {
    EXPECT_NE(Shaping(row), Shaping(row - 1)) << AblationRows()[row].name;
  }
}

TEST(AblationRows, EndWithTheProgramAsItIs) {
  const size_t last = AblationRows().size() - 1;
  EXPECT_EQ(Shaping(last), ShapingOptionsToJson(RunOptions{}));
  RunOptions asked;
  asked.split.views = 12;
  asked.start = {StartKind::kHybrid, 0.7, 0.1, 0.5, false, 3};
  asked.propose.proposers = ProposerChoice::kSplat, asked.propose.proposal_folder = "/somewhere";
  asked.validate.pick = PickRule::kPixel;
  asked.train.iterations = 100, asked.train.depth_weight = 2, asked.train.dropout = 0.1,
  asked.train.exposure = ExposureMode::kOn;
  asked.train.schedule = ScheduleKind::kConstant, asked.train.coarse_share = 0.2, asked.train.prune_floaters = true;
  EXPECT_EQ(Shaping(last, asked), ShapingOptionsToJson(asked));
}

TEST(AblationRows, BeginWithMcmcAlone) {
  RunOptions asked;
  asked.split.views = 12, asked.train.iterations = 100, asked.start.seed = 4;
  asked.train.coarse_share = 0.3, asked.train.prune_floaters = true, asked.propose.proposal_folder = "/somewhere";
  const RunOptions first = RowOptions(0, asked);
  EXPECT_EQ(first.start.init, StartKind::kRandom);
  EXPECT_EQ(first.propose.proposers, ProposerChoice::kNone);
  EXPECT_TRUE(first.propose.proposal_folder.empty());
  const TrainOptions& t = first.train;
  EXPECT_EQ(t.depth_weight + t.alpha_weight + t.coarse_share + t.proposal_lpips, 0);
  EXPECT_EQ(t.opacity_noise, 0.);
  EXPECT_EQ(t.dropout, 0.);
  EXPECT_EQ(t.last_rates, 1.);
  EXPECT_FALSE(t.prune_floaters);
  EXPECT_EQ(t.largest_scale, 0);
  EXPECT_EQ(t.exposure, ExposureMode::kOff);
  EXPECT_EQ(first.split.views, 12) << "what no row is about holds for all of them";
  EXPECT_EQ(t.iterations, 100);
  EXPECT_EQ(first.start.seed, 4u);
}

TEST(AblationRows, UseLpipsInTheLastAlone) {
  for (size_t row = 0; row < AblationRows().size(); ++row) {
    const double share = RowOptions(row, {}).train.proposal_lpips;
    EXPECT_EQ(share, row + 1 < AblationRows().size() ? 0 : TrainOptions().proposal_lpips) << AblationRows()[row].name;
  }
}

TEST(AblationRows, CalibrateTheOracleInARowOfItsOwn) {
  for (size_t row = 0; row < AblationRows().size(); ++row) {
    EXPECT_EQ(RowOptions(row, {}).validate.calibrate, row >= 8) << AblationRows()[row].name;
  }
}

TEST(AblationRows, LeaveOffWhatTheUserSwitchedOff) {
  RunOptions asked;
  asked.train.depth_weight = 0;
  asked.train.schedule = ScheduleKind::kConstant;
  EXPECT_EQ(Shaping(4, asked), Shaping(3, asked));
  EXPECT_EQ(Shaping(2, asked), Shaping(1, asked));
  asked.validate.oracle = OracleKind::kUniform;
  EXPECT_EQ(Shaping(5, asked), Shaping(4, asked)) << "nobody to trust";
  EXPECT_EQ(Shaping(8, asked), Shaping(7, asked)) << "nothing to calibrate";
  asked.propose.proposers = ProposerChoice::kNone, asked.propose.proposal_folder = "/somewhere";
  EXPECT_EQ(RowOptions(1, asked).propose.proposers, ProposerChoice::kNone);
  EXPECT_EQ(RowOptions(1, asked).propose.proposal_folder, "/somewhere");
}

TEST(AblationRows, AskAGeneratorWithTheProxyModels) {
  RunOptions asked;
  asked.propose.generator = "generate";
  EXPECT_EQ(RowOptions(0, asked).propose.generator, "");
  EXPECT_EQ(RowOptions(8, asked).propose.generator, "");
  EXPECT_EQ(RowOptions(9, asked).propose.generator, "generate");
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
  options.propose.proposers = ProposerChoice::kNone;
  EXPECT_THAT(MessageOf<UsageError>([&] { RequireAblatable(options); }), HasSubstr("--proposers none"));
  options.propose.proposal_folder = "/somewhere";
  RequireAblatable(options);
  options.train.schedule = ScheduleKind::kNone;
  EXPECT_THAT(MessageOf<UsageError>([&] { RequireAblatable(options); }), HasSubstr("--schedule none"));
  RunOptions blind;
  blind.depth.depth_prior = DepthPrior::kNone;
  EXPECT_THAT(MessageOf<UsageError>([&] { RequireAblatable(blind); }), HasSubstr("--depth-prior none"));
  for (const StartKind init : {StartKind::kRandom, StartKind::kSfm}) {
    RunOptions other;
    other.start.init = init;
    EXPECT_THAT(MessageOf<UsageError>([&] { RequireAblatable(other); }), HasSubstr("--init " + Word(init)));
  }
}

}  // namespace
}  // namespace oraclegs
