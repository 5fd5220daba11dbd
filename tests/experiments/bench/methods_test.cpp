#include "oraclegs/experiments/bench/methods.h"

#include <gmock/gmock.h>

#include <set>

#include "oraclegs/settings/plan.h"
#include "support/errors.h"

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// The options of a method's run where neither a suite nor a user sets any.
RunOptions OptionsOfMethod(const Method& method, const std::string& suite = "folder") {
  const MethodSettings settings = method.For(suite);
  return OptionsOf(Overlaid(settings.usual, settings.options));
}

TEST(Methods, AreValidAndHaveNamesOfTheirOwn) {
  std::set<std::string> names, labels;
  for (const Method& method : Methods()) {
    EXPECT_TRUE(names.insert(method.name).second) << method.name;
    EXPECT_TRUE(labels.insert(method.label).second) << method.label;
    if (!method.options) continue;  // of a preset, which presets_test.py reads
    for (const char* suite : {"folder", "llff", "dtu", "blender", "mipnerf360"}) {
      EXPECT_EQ(RunOptionsToJson(OptionsOfMethod(method, suite)), RunOptionsToJson(method.options(method, suite)))
          << method.name << " " << suite;
    }
  }
}

TEST(Methods, OursIsWhatReconstructDoes) {
  const MethodSettings ours = FindMethods("ours")[0].For("folder");
  EXPECT_TRUE(ours.options.empty() && ours.usual.empty());
  EXPECT_FALSE(HasProposals(OptionsOfMethod(FindMethods("ours-no-proposals")[0])));
}

TEST(Methods, APresetOfTheUserIsForOursAlone) {
  std::vector<std::string> own;
  for (const Method& method : Methods()) {
    if (method.is_own()) own.push_back(method.name);
  }
  EXPECT_THAT(own, testing::ElementsAre("ours", "ours-no-proposals"));
}

TEST(Methods, McmcIsThePublishedTraining) {
  const RunOptions options = OptionsOfMethod(FindMethods("3dgs-mcmc")[0]);
  EXPECT_FALSE(HasProposals(options));
  EXPECT_EQ(options.start.init, Auto<StartKind>(StartKind::kDense));
  EXPECT_EQ(options.start.init_scale, Auto<double>(0.1));
  EXPECT_FALSE(options.method.Settings().adaptive);
  EXPECT_EQ(options.train.iterations, Auto<int>(10000));
}

TEST(Methods, IterationsAndStartAreTheUsers) {
  const MethodSettings settings = FindMethods("cor-gs")[0].For("mipnerf360");
  EXPECT_EQ(settings.usual, (RunArguments{{"init", "dense"}, {"iterations", "30000"}}));
  EXPECT_EQ(FindMethods("3dgs-mcmc-random")[0].For("folder").usual, (RunArguments{{"iterations", "10000"}}));
}

TEST(Methods, TrainAsTheirRows) {
  for (const char* name : {"3dgs", "dropgaussian", "fsgs", "cor-gs", "dngaussian", "sparsegs", "comapgs"}) {
    const RunOptions options = OptionsOfMethod(FindMethods(name)[0]);
    EXPECT_EQ(options.method.method, name);
    EXPECT_TRUE(options.method.Settings().adaptive) << name;
    EXPECT_EQ(options.start.init_opacity, 0.1) << name;
  }
  EXPECT_EQ(OptionsOfMethod(FindMethods("dngaussian")[0], "llff").method.method, "dngaussian-llff");
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
