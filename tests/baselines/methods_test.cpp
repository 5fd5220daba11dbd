#include "oraclegs/baselines/methods.h"
#include "baselines/baseline_trainer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "support/errors.h"

namespace oraclegs {
namespace {

// Every option of the trainer as the authors of 3DGS-MCMC have it; "auto" where it has no say. An option that is new or
// has another default does not belong here before somebody has looked what it is in their program.
constexpr const char* kPublished = R"({
  "iterations": 10000, "horizon": 0, "max-gaussians": "auto", "sh-degree": 3, "sh-degree-interval": 1000,
  "sh-moments": "full", "antialiased": false, "ssim-weight": 0.2, "schedule": "auto", "synthetic-floor": "auto",
  "synthetic-peak": 8.533333333333333, "proposal-weight": 1, "proposal-ssim": 0.3, "proposal-lpips": 0.3,
  "confidence-gate": 0, "confidence-power": 1, "depth-weight": 0, "depth-loss": "relative", "alpha-weight": 0,
  "exposure": "off", "dropout": 0, "opacity-noise": 0, "prune-floaters": false, "largest-scale": 0, "rate-scale": 1,
  "last-rates": 1, "opacity-reg": 0.01, "scale-reg": 0.01, "random-points": 100000, "refine-start": 500,
  "refine-every": 100, "refine-stop": 0.8333333333333334
})";

// Options that concern proposals, which no published method has.
const std::set<std::string> kOfProposals = {"schedule",      "synthetic-floor", "synthetic-peak",  "proposal-weight",
                                            "proposal-ssim", "proposal-lpips",  "confidence-gate", "confidence-power"};

TEST(Published3dgs, HasNoDefaultOfOurs) {
  nlohmann::json expected = nlohmann::json::parse(kPublished), is = OptionsToJson(Published3dgs());
  for (const std::string& name : kOfProposals) expected.erase(name), is.erase(name);
  EXPECT_EQ(nlohmann::json::diff(expected, is), nlohmann::json::array());
}

TEST(BaselineMethods, HaveWordsOfTheirOwnAndOptionsInRange) {
  std::set<std::string> words;
  for (const BaselineMethod& method : BaselineMethods()) {
    EXPECT_TRUE(words.insert(method.word).second) << method.word;
    EXPECT_NO_THROW(CheckOptions(method.train)) << method.word;
  }
}

TEST(BaselineMethods, HaveTheirMechanisms) {
  for (const std::string name : {"3dgs", "dropgaussian", "fsgs", "cor-gs", "dngaussian", "sparsegs", "comapgs"}) {
    const BaselineMethod& method = FindBaseline(name);
    EXPECT_TRUE(method.own.adaptive) << name;
    EXPECT_EQ(method.train.opacity_reg + method.train.scale_reg + method.train.largest_scale, 0) << name;
    EXPECT_EQ(method.own.two_fields, name == "cor-gs") << name;
    EXPECT_EQ(method.own.unpool_until > 0, name == "fsgs") << name;
    EXPECT_EQ(method.own.pseudo_depth_weight > 0, name == "fsgs") << name;
    EXPECT_EQ(method.train.dropout.value() > 0, name == "dropgaussian") << name;
    EXPECT_EQ(method.own.hard_depth, name == "dngaussian") << name;
    EXPECT_EQ(method.own.prune_modes_at > 0, name == "sparsegs") << name;
    EXPECT_EQ(method.own.patched_correlation > 0, name == "sparsegs") << name;
    EXPECT_EQ(method.own.covisibility_weights, name == "comapgs") << name;
  }
  EXPECT_FALSE(FindBaseline("3dgs-mcmc").own.adaptive);
}

TEST(BaselineFor, HasTheSettingsOfADatasetWhereTheirAuthorsDo) {
  EXPECT_EQ(BaselineFor("cor-gs", "llff").own.co_prune_distance, 5);
  EXPECT_EQ(BaselineFor("cor-gs", "dtu").own.co_prune_distance, 10);
  EXPECT_EQ(BaselineFor("cor-gs", "dtu").own.co_start, 2000);
  EXPECT_FALSE(BaselineFor("cor-gs", "blender").own.random_background);
  EXPECT_EQ(BaselineFor("cor-gs", "mipnerf360").own.co_prune_distance, 20);
  EXPECT_EQ(BaselineFor("cor-gs", "mipnerf360").train.iterations, Auto<int>(30000));
  EXPECT_EQ(BaselineFor("fsgs", "folder").own.pseudo_depth_weight, 0.05);
  EXPECT_EQ(BaselineFor("fsgs", "folder").own.pseudo_depth_every, 10);
  EXPECT_EQ(BaselineFor("fsgs", "mipnerf360").own.pseudo_depth_weight, 0.03);
  EXPECT_EQ(BaselineFor("fsgs", "llff").own.pseudo_depth_every, 1);
  EXPECT_EQ(BaselineFor("fsgs", "llff").own.pseudo_depth_weight, 0.5);
  EXPECT_EQ(BaselineFor("dngaussian", "llff").own.depth_tolerance, 0.00025);
  EXPECT_EQ(BaselineFor("dngaussian", "dtu").own.densify_opacity, 0.1);
  EXPECT_EQ(BaselineFor("dngaussian", "blender").own.soft_depth_start, 0);
  EXPECT_EQ(BaselineFor("dngaussian", "folder").own.soft_depth_start, 1000);
}

TEST(FindBaseline, ListsThoseThereAre) {
  EXPECT_THAT(MessageOf<UsageError>([] { FindBaseline("3dgs-mcm"); }),
              testing::AllOf(testing::HasSubstr("--set method is '3dgs-mcm'; there are 3dgs, 3dgs-mcmc"),
                             testing::HasSubstr("did you mean '3dgs-mcmc'?")));
}

using testing::HasSubstr;

TEST(AddBaseline, AddsNothingUnlessItIsAskedFor) {
  BaselineSetup setup = SmallSetup(Options(), Photos(2));
  AddBaseline(&setup);
  EXPECT_TRUE(setup.parts.empty());
  EXPECT_FALSE(setup.densifier);
}

TEST(AddBaseline, MakesWhatTheSettingsName) {
  BaselineSetup setup = SmallSetup(Options(), Photos(2));
  setup.baseline.adaptive = setup.baseline.two_fields = setup.baseline.random_background = true;
  setup.baseline.prune_modes_at = 5;
  AddBaseline(&setup);
  EXPECT_EQ(setup.parts.size(), 3);
  EXPECT_TRUE(setup.densifier);
}

TEST(CheckBaseline, RefusesWhatTheTrainingWouldIgnore) {
  AutoTrainOptions options;
  options.iterations = 60;
  BaselineSettings settings;
  settings.prune_modes_at = 61;
  EXPECT_THAT(MessageOf<UsageError>([&] { CheckBaseline("--set method=sparsegs", settings, options); }),
              HasSubstr("--set method=sparsegs prunes at iteration 61, which lies beyond the last of 60 --iterations"));
  settings.prune_modes_at = 60;
  EXPECT_NO_THROW(CheckBaseline("--set method=sparsegs", settings, options));
  settings.adaptive = options.prune_floaters = true;
  EXPECT_THAT(MessageOf<UsageError>([&] { CheckBaseline("--set method=sparsegs", settings, options); }),
              HasSubstr("--prune-floaters belongs to relocation, which --set method=sparsegs does not have"));
}

}  // namespace

}  // namespace oraclegs
