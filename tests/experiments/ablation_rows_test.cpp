#include "oraclegs/experiments/ablation_rows.h"
#include "experiments/paper_tables.h"
#include "oraclegs/baselines/methods.h"
#include "oraclegs/experiments/bench/suites.h"

#include <gmock/gmock.h>

#include "run/fixtures.h"
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
  asked.start = {SfmPoints::kModel, StartKind::kHybrid, 0.7, 0.1, false, 3};
  asked.propose.proposers = std::string("proxies"), asked.propose.proposal_folder = "/somewhere";
  asked.validate.pick = PickRule::kPixel;
  asked.train.iterations = 100, asked.train.depth_weight = 2, asked.train.dropout = 0.1,
  asked.train.exposure = ExposureMode::kOn;
  asked.train.schedule = ScheduleKind::kConstant, asked.train.prune_floaters = true;
  EXPECT_EQ(Shaping(last, asked), ShapingOptionsToJson(asked));
}

TEST(AblationRows, BeginWithMcmcAlone) {
  RunOptions asked;
  asked.split.views = 12, asked.train.iterations = 100, asked.start.seed = 4;
  asked.train.prune_floaters = true, asked.propose.proposal_folder = "/somewhere";
  const RunOptions first = RowOptions(0, asked);
  EXPECT_EQ(first.start.init, StartKind::kRandomCube);
  EXPECT_EQ(first.propose.proposers, std::string("none"));
  EXPECT_TRUE(first.propose.proposal_folder.empty());
  const AutoTrainOptions& t = first.train;
  EXPECT_EQ(t.depth_weight + t.alpha_weight + t.proposal_lpips, 0);
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

/// The training of a row without the sizes, which all rows share, and without what proposals and depth do to it.
nlohmann::json McmcOptions(const AutoTrainOptions& train) {
  nlohmann::json json = OptionsToJson(train);
  for (const char* left_out :
       {"iterations", "horizon", "max-gaussians", "schedule", "synthetic-floor", "synthetic-peak", "proposal-ssim",
        "proposal-lpips", "confidence-power", "depth-weight", "depth-loss"}) {
    json.erase(left_out);
  }
  return json;
}

TEST(AblationRows, TrainAs3dgsMcmcsAuthorsUntilTheRegularizers) {
  RunOptions usual, other;
  usual.train.iterations = other.train.iterations = 4000, other.train.horizon = 30000, other.train.max_gaussians = 77;
  AutoTrainOptions& t = other.train;
  t.rate_scale = 3, t.sh_moments = ShMoments::kCompact, t.refine_start = 7, t.refine_every = 9, t.refine_stop = 0.1;
  t.sh_degree = 1, t.sh_degree_interval = 11, t.opacity_reg = t.scale_reg = 0.5, t.antialiased = true;
  t.ssim_weight = 0.7, t.random_points = 123, other.start.init_opacity = 0.7;
  t.depth_loss = DepthLoss::kPaper, t.synthetic_floor = 0.3;
  for (const RunOptions& asked : {usual, other}) {
    for (size_t row = 0; row < AblationRows().size(); ++row) {
      const RunOptions options = RowOptions(row, asked);
      const bool own = row >= 8;
      EXPECT_EQ(McmcOptions(options.train) == McmcOptions(Published3dgs()), !own) << AblationRows()[row].name;
      EXPECT_EQ(options.train.iterations, asked.train.iterations);
      EXPECT_EQ(options.train.horizon, asked.train.horizon);
      EXPECT_EQ(options.train.max_gaussians, asked.train.max_gaussians);
      EXPECT_EQ(options.train.synthetic_floor, asked.train.synthetic_floor);
      EXPECT_EQ(options.start.init_opacity, row < 7 ? 0.5 : asked.start.init_opacity);
      EXPECT_EQ(options.train.depth_loss, asked.train.depth_loss);
    }
  }
}

TEST(AblationRows, BeginWithThePapersInItsOrder) {
  std::vector<std::string> names;
  for (const AblationRow& row : AblationRows()) names.push_back(row.name);
  names.resize(7);
  EXPECT_THAT(names, ElementsAre("mcmc", "union", "schedule", "lpips", "sfm", "depth", "confidence"));
  RunOptions paper;
  paper.validate.calibrate = false, paper.start.init = StartKind::kSfm, paper.start.init_scale = 0.1,
  paper.propose.proposers = std::string("seva");
  AutoTrainOptions& t = paper.train;
  t.schedule = ScheduleKind::kPaper, t.exposure = ExposureMode::kOff, t.iterations = 15000, t.horizon = 30000;
  t.dropout = 0, t.opacity_noise = 0, t.rate_scale = t.last_rates = 1, t.largest_scale = 0, t.alpha_weight = 0;
  t.refine_start = 500, t.refine_every = 100, t.sh_degree_interval = 1000, t.sh_moments = ShMoments::kFull;
  t.depth_loss = DepthLoss::kPaper;
  EXPECT_EQ(Shaping(6, paper), ShapingOptionsToJson(paper)) << "the paper's preset is the last of its rows";
  EXPECT_EQ(Shaping(10, paper), Shaping(6, paper));
}

TEST(AblationRows, DrawProposalsFromOnePileUntilTheScheduleComes) {
  EXPECT_EQ(RowOptions(1, {}).train.schedule, ScheduleKind::kUnion);
  EXPECT_EQ(RowOptions(2, {}).train.schedule, ScheduleKind::kPaper);
}

TEST(AblationRows, UseLpipsFromItsRowOn) {
  for (size_t row = 0; row < AblationRows().size(); ++row) {
    const double share = RowOptions(row, {}).train.proposal_lpips;
    EXPECT_EQ(share, row < 3 ? 0 : TrainOptions().proposal_lpips) << AblationRows()[row].name;
  }
}

TEST(AblationRows, TakeTheGeneratorThatIsAskedFor) {
  const auto proposer = [](const std::string& choice) {
    RunOptions asked;
    asked.propose.proposers = choice;
    EXPECT_EQ(RowOptions(10, asked).propose.proposers, choice);
    return RowOptions(1, asked).propose.proposers;
  };
  EXPECT_EQ(proposer("proxies"), std::string("warp"));
  EXPECT_EQ(proposer("proxies,warp"), std::string("warp"));
  EXPECT_EQ(proposer("warp"), std::string("warp"));
  EXPECT_EQ(proposer("seva"), std::string("seva"));
  EXPECT_EQ(proposer("proxies,warp,seva"), std::string("seva"));
  EXPECT_EQ(proposer("none"), std::string("none")) << "a folder alone";
}

TEST(AblationRows, CalibrateTheOracleInARowOfItsOwn) {
  for (size_t row = 0; row < AblationRows().size(); ++row) {
    EXPECT_EQ(RowOptions(row, {}).validate.calibrate, row >= 9) << AblationRows()[row].name;
  }
}

TEST(AblationRows, LeaveOffWhatTheUserSwitchedOff) {
  RunOptions asked;
  asked.train.depth_weight = 0;
  EXPECT_EQ(Shaping(5, asked), Shaping(4, asked));
  asked.train.schedule = ScheduleKind::kConstant;
  EXPECT_EQ(RowOptions(8, asked).train.schedule, ScheduleKind::kConstant);
  asked.validate.oracle = OracleKind::kUniform;
  EXPECT_EQ(Shaping(6, asked), Shaping(5, asked)) << "nobody to trust";
  EXPECT_EQ(Shaping(9, asked), Shaping(8, asked)) << "nothing to calibrate";
  asked.propose.proposers = std::string("none"), asked.propose.proposal_folder = "/somewhere";
  EXPECT_EQ(RowOptions(1, asked).propose.proposers, std::string("none"));
  EXPECT_EQ(RowOptions(1, asked).propose.proposal_folder, "/somewhere");
}

TEST(AblationRows, AskAGeneratorAloneBeforeTheProxyModels) {
  RunOptions asked;
  asked.propose.generator = "generate";
  EXPECT_EQ(RowOptions(0, asked).propose.generator, "");
  for (const size_t row : {1, 9}) {
    EXPECT_EQ(RowOptions(row, asked).propose.generator, "generate");
    EXPECT_EQ(RowOptions(row, asked).propose.proposers, std::string("command"));
  }
  EXPECT_THAT(RowOptions(10, asked).propose.Words(), ElementsAre("proxies", "command"));
}

TEST(ChooseRows, ByNumberAndName) {
  EXPECT_EQ(ChooseRows("").size(), AblationRows().size());
  EXPECT_THAT(ChooseRows("depth, 1,union,2"), ElementsAre(0, 1, 5));
  EXPECT_THAT(ChooseRows("lpips,9"), ElementsAre(3, 8));
  for (const char* bad : {"magic", "0", "12", "1,,2", "1,"}) {
    EXPECT_THAT(MessageOf<UsageError>([&] { ChooseRows(bad); }), AllOf(HasSubstr("--rows"), HasSubstr("6 depth")))
        << bad;
  }
}

TEST(RequireAblatable, RefusesOptionsThatContradictTheRows) {
  RequireAblatable({});
  RunOptions options;
  options.propose.proposers = std::string("none");
  EXPECT_THAT(MessageOf<UsageError>([&] { RequireAblatable(options); }), HasSubstr("--proposers none"));
  options.propose.proposal_folder = "/somewhere";
  RequireAblatable(options);
  options.train.schedule = ScheduleKind::kNone;
  EXPECT_THAT(MessageOf<UsageError>([&] { RequireAblatable(options); }), HasSubstr("--schedule none"));
  RunOptions blind;
  blind.depth.depth_prior = DepthPrior::kNone;
  EXPECT_THAT(MessageOf<UsageError>([&] { RequireAblatable(blind); }), HasSubstr("--depth-prior none"));
  for (const StartKind init : {StartKind::kRandom, StartKind::kRandomCube}) {
    RunOptions other;
    other.start.init = init;
    EXPECT_THAT(MessageOf<UsageError>([&] { RequireAblatable(other); }), HasSubstr("--init " + Word(init)));
  }
  RunOptions generated;
  generated.propose.proposers = std::string("seva");
  EXPECT_THAT(MessageOf<InputError>([&] { RequireNetworksOfRows(generated); }),
              HasSubstr("oraclegs models fetch seva"));
}

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
