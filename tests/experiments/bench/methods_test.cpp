#include "oraclegs/experiments/bench/methods.h"

#include <gmock/gmock.h>

#include <set>

#include "oraclegs/settings/plan.h"
#include "support/errors.h"

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(Methods, AreValidAndHaveNamesOfTheirOwn) {
  std::set<std::string> names, labels;
  for (const Method& method : Methods()) {
    EXPECT_TRUE(names.insert(method.name).second) << method.name;
    EXPECT_TRUE(labels.insert(method.label).second) << method.label;
    EXPECT_NO_THROW(OptionsOf(Overlaid(method.usual, method.options))) << method.name;
  }
}

TEST(Methods, OursIsWhatReconstructDoes) {
  EXPECT_TRUE(FindMethods("ours")[0].options.empty());
  EXPECT_FALSE(HasProposals(OptionsOf(FindMethods("ours-no-proposals")[0].options)));
}

TEST(Methods, McmcIsThePublishedTraining) {
  const Method mcmc = FindMethods("3dgs-mcmc")[0];
  const RunOptions options = OptionsOf(Overlaid(mcmc.usual, mcmc.options));
  EXPECT_FALSE(HasProposals(options));
  EXPECT_EQ(options.start.init, Auto<StartKind>(StartKind::kDense));
  EXPECT_EQ(options.start.init_scale, Auto<double>(0.1));
  EXPECT_EQ(options.train.baseline.densify, Densify::kMcmc);
  EXPECT_EQ(options.train.depth_weight, 0);
  EXPECT_EQ(options.train.rate_scale, Auto<double>(1));
  EXPECT_EQ(options.train.iterations, Auto<int>(10000));
  EXPECT_EQ(options.train.exposure, ExposureMode::kOff);
}

TEST(Methods, BaselinesHaveTheirMechanisms) {
  const auto train = [](const char* name) {
    const Method method = FindMethods(name)[0];
    return OptionsOf(Overlaid(method.usual, method.options)).train;
  };
  for (const char* name : {"3dgs", "dropgaussian", "fsgs", "cor-gs", "dngaussian", "sparsegs", "comapgs"}) {
    const TrainOptions options = train(name);
    EXPECT_EQ(options.baseline.densify, Densify::kAdaptive) << name;
    EXPECT_EQ(options.opacity_reg + options.scale_reg + options.largest_scale, 0) << name;
    EXPECT_EQ(options.baseline.two_fields, name == std::string("cor-gs")) << name;
    EXPECT_EQ(options.baseline.unpool_until > 0, name == std::string("fsgs")) << name;
    EXPECT_EQ(options.baseline.pseudo_depth_weight > 0, name == std::string("fsgs")) << name;
    EXPECT_EQ(options.dropout.value() > 0, name == std::string("dropgaussian")) << name;
    EXPECT_EQ(options.baseline.hard_depth, name == std::string("dngaussian")) << name;
    EXPECT_EQ(options.baseline.prune_modes_at > 0, name == std::string("sparsegs")) << name;
    EXPECT_EQ(options.baseline.covisibility_weights, name == std::string("comapgs")) << name;
  }
  EXPECT_EQ(train("fsgs").depth_loss, DepthLoss::kCorrelation);
}

TEST(Methods, HaveTheSettingsOfADatasetWhereTheirAuthorsDo) {
  const auto baseline = [](const char* name, const char* suite) {
    const Method method = FindMethods(name)[0];
    const SuiteSettings settings = method.For(suite);
    return OptionsOf(Overlaid(settings.usual, settings.options)).train;
  };
  EXPECT_EQ(baseline("cor-gs", "llff").baseline.co_prune_distance, 5);
  EXPECT_EQ(baseline("cor-gs", "dtu").baseline.co_prune_distance, 10);
  EXPECT_EQ(baseline("cor-gs", "dtu").baseline.co_start, 2000);
  EXPECT_EQ(baseline("cor-gs", "mipnerf360").baseline.co_prune_distance, 20);
  EXPECT_EQ(baseline("cor-gs", "mipnerf360").iterations, Auto<int>(30000));
  EXPECT_EQ(baseline("fsgs", "folder").baseline.pseudo_depth_weight, 0.05);
  EXPECT_EQ(baseline("fsgs", "folder").baseline.pseudo_depth_every, 10);
  EXPECT_EQ(baseline("fsgs", "mipnerf360").baseline.pseudo_depth_weight, 0.03);
  EXPECT_EQ(baseline("fsgs", "llff").baseline.pseudo_depth_every, 1);
  EXPECT_EQ(baseline("fsgs", "llff").baseline.pseudo_depth_weight, 0.5);
  EXPECT_EQ(baseline("dngaussian", "llff").baseline.depth_tolerance, 0.00025);
  EXPECT_EQ(baseline("dngaussian", "dtu").baseline.densify_opacity, 0.1);
  EXPECT_EQ(baseline("dngaussian", "blender").baseline.soft_depth_start, 0);
  EXPECT_EQ(baseline("dngaussian", "folder").baseline.soft_depth_start, 1000);
}

TEST(FindMethods, TakesEachOnceInTheOrderOfTheList) {
  const auto methods = FindMethods("3dgs-mcmc, ours,3dgs-mcmc");
  ASSERT_EQ(methods.size(), 2u);
  EXPECT_EQ(methods[0].name, "3dgs-mcmc");
  EXPECT_EQ(methods[1].name, "ours");
}

TEST(FindMethods, ListsThoseThereAre) {
  EXPECT_THAT(MessageOf<UsageError>([] { FindMethods("ours,3dgs-mcm"); }),
              AllOf(HasSubstr("'3dgs-mcm'"), HasSubstr("ours-no-proposals"), HasSubstr("did you mean '3dgs-mcmc'?")));
  EXPECT_THAT(MessageOf<UsageError>([] { FindMethods(" ,"); }), HasSubstr("names none"));
}

}  // namespace
}  // namespace oraclegs
