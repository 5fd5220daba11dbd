#include "oraclegs/train/methods/make_parts.h"

#include <gtest/gtest.h>

#include "train/small_scene.h"

namespace oraclegs {
namespace {

TEST(MakeMethodParts, NoneUnlessTheyAreAskedFor) {
  EXPECT_TRUE(MakeMethodParts({Options(), kSeed, {0, 0, 0}, Photos(2), Start()}).empty());
}

TEST(MakeMethodParts, TwoFieldsNeedAdaptiveDensity) {
  TrainSetup setup{Options(), kSeed, {0, 0, 0}, Photos(2), Start()};
  setup.options.baseline.two_fields = true;
  EXPECT_THROW(MakeMethodParts(setup), UsageError);
  setup.options.baseline.densify = Densify::kAdaptive;
  EXPECT_EQ(MakeMethodParts(setup).size(), 1);
}

TEST(MakeMethodParts, RefusesWhatTheOtherDensificationWouldIgnore) {
  TrainSetup setup{Options(), kSeed, {0, 0, 0}, Photos(2), Start()};
  setup.options.baseline.unpool_until = 2000;
  EXPECT_THROW(MakeMethodParts(setup), UsageError);
  setup.options.baseline = {};
  setup.options.baseline.keep_large = true;
  EXPECT_THROW(MakeMethodParts(setup), UsageError);
  setup.options.baseline.densify = Densify::kAdaptive;
  EXPECT_TRUE(MakeMethodParts(setup).empty());
  setup.options.prune_floaters = true;
  EXPECT_THROW(MakeMethodParts(setup), UsageError);
}

}  // namespace
}  // namespace oraclegs
