#include "oraclegs/settings/options.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <set>

#include "support/errors.h"

namespace oraclegs {
namespace {

TEST(RunOptions, HaveEveryNameOnce) {
  const RunOptions options;
  std::set<std::string> names;
  RunOptions::ForEachGroup(options, [&](const char*, const auto& group) {
    for (const NamedOption& option : ListOptions(group)) EXPECT_TRUE(names.insert(option.name).second) << option.name;
  });
  EXPECT_EQ(RunOptionsToJson(options).size(), names.size());
}

TEST(RunOptions, SaveWordsAndAuto) {
  RunOptions options;
  EXPECT_EQ(ShapingOptionsToJson(options).at("init"), "auto");
  EXPECT_EQ(ShapingOptionsToJson(options).at("init-scale"), "auto");
  EXPECT_EQ(ShapingOptionsToJson(options).at("init-planes"), true);
  options.start.init = StartKind::kHybrid, options.depth.depth_prior = DepthPrior::kMonocular;
  options.start.init_scale = 0.5, options.validate.oracle = OracleKind::kVggtAndConsistency;
  const nlohmann::json json = ShapingOptionsToJson(options);
  EXPECT_EQ(json.at("init"), "hybrid");
  EXPECT_EQ(json.at("init-scale"), 0.5);
  EXPECT_EQ(json.at("depth-prior"), "depth-anything");
  EXPECT_EQ(json.at("oracle"), "vggt+consistency");
  EXPECT_FALSE(json.contains("threads")) << "it shapes no result";
  EXPECT_EQ(RunOptionsToJson(options).at("lpips"), "auto");
}

TEST(RunOptions, AreCheckedInEveryGroup) {
  RunOptions options;
  CheckRunOptions(options);
  options.machine.threads = -1;
  EXPECT_THAT(MessageOf<UsageError>([&] { CheckRunOptions(options); }), testing::HasSubstr("--threads is -1"));
  options = {};
  options.start.init_scale = 0.;
  EXPECT_THAT(MessageOf<UsageError>([&] { CheckRunOptions(options); }), testing::HasSubstr("--set init-scale is 0"));
}

TEST(RunOptions, RefuseAMethodThatNeedsDepthWithoutDepth) {
  RunOptions options;
  for (const char* method : {"fsgs", "dngaussian", "sparsegs", "comapgs"}) {
    options.method.method = method;
    options.depth.depth_prior = {};
    CheckRunOptions(options);
    options.depth.depth_prior = DepthPrior::kNone;
    EXPECT_EQ(
        MessageOf<UsageError>([&] { CheckRunOptions(options); }),
        fmt::format("--set method={} needs depth, and --depth-prior none finds none; leave one of them out", method));
  }
  options.method.method = "3dgs";
  CheckRunOptions(options);
}

TEST(RunOptions, RefuseAMethodThatIsNone) {
  RunOptions options;
  options.method.method = "dnguassian";
  EXPECT_THAT(MessageOf<UsageError>([&] { CheckRunOptions(options); }),
              testing::HasSubstr("did you mean 'dngaussian'?"));
}

TEST(RunOptions, NameLayersAndWeightsOfVggt) {
  RunOptions options;
  options.validate.vggt_layers = "0,22", options.validate.vggt_layer_weights = "1,3";
  EXPECT_NO_THROW(CheckRunOptions(options));
  options.validate.vggt_layer_weights = "1,-3";
  EXPECT_THAT(MessageOf<UsageError>([&] { CheckRunOptions(options); }), testing::HasSubstr("--set vggt-layer-weights"));
}

TEST(RunOptions, AskForAGeneratorAndItsCommandTogether) {
  const auto error = [](const std::string& proposers, const std::string& command) {
    RunOptions options;
    options.propose.proposers = proposers, options.propose.generator = command;
    return MessageOf<UsageError>([&] { CheckRunOptions(options); });
  };
  EXPECT_EQ(error("command", "true"), "");
  EXPECT_EQ(error("warp", "true"), "");
  EXPECT_THAT(error("wrap", ""), testing::HasSubstr("did you mean 'warp'?"));
  EXPECT_THAT(error("command", ""), testing::HasSubstr("--proposers command needs --generator"));
  EXPECT_THAT(error("none", "true"), testing::HasSubstr("say --proposers command"));
  EXPECT_THAT(error("command", "\xff"), testing::HasSubstr("--generator is not valid UTF-8"));
}

TEST(RunOptions, RefuseAMaskCommandThatIsNoText) {
  RunOptions options;
  options.masks.masks = "\xff";
  EXPECT_THAT(MessageOf<UsageError>([&] { CheckRunOptions(options); }),
              testing::HasSubstr("--masks is not valid UTF-8"));
}

TEST(RunOptions, MayBeContinuedWithAnotherTimeLimit) {
  RunOptions options;
  const nlohmann::json before = ShapingOptionsToJson(options);
  options.generator_limits.generator_timeout = 7;
  EXPECT_EQ(ShapingOptionsToJson(options), before);
  EXPECT_EQ(RunOptionsToJson(options).at("generator-timeout"), 7);
}

}  // namespace
}  // namespace oraclegs
