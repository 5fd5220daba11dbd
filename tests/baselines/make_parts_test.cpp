#include "oraclegs/baselines/make_parts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "baselines/baseline_trainer.h"
#include "support/errors.h"

namespace oraclegs {
namespace {

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
