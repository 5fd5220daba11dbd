#include "oraclegs/settings/named_options.h"

#include <nlohmann/json.hpp>

#include "support/errors.h"

namespace oraclegs {
namespace {

using nlohmann::json;
using testing::HasSubstr;

TEST(RunOptionNames, HasThoseOfAllGroups) {
  EXPECT_THAT(RunOptionNames(), testing::IsSupersetOf({"views", "iterations", "proposers", "threads", "report"}));
}

TEST(SetRunOptions, TakesNumbersTextsAndTruthValues) {
  RunOptions options;
  SetRunOptions(json::parse(R"({"views": 12, "init": "dense", "report": false, "opacity-reg": 0.5, "dropout": "auto",
                                "init-scale": "0.25", "images": "some/folder"})"),
                UnknownOption::kError, &options);
  EXPECT_EQ(options.split.views, 12);
  EXPECT_EQ(options.start.init, StartKind::kDense);
  EXPECT_FALSE(options.report.report);
  EXPECT_EQ(options.train.opacity_reg, 0.5);
  EXPECT_EQ(options.start.init_scale, 0.25);
  EXPECT_EQ(options.input.images, "some/folder");
}

TEST(SetRunOptions, ReadsBackWhatARunSaves) {
  RunOptions options, read;
  options.split.views = 5, options.train.sh_degree = 2, options.start.init = StartKind::kRandom;
  SetRunOptions(RunOptionsToJson(options), UnknownOption::kError, &read);
  EXPECT_EQ(RunOptionsToJson(read), RunOptionsToJson(options));
}

TEST(RunOptionWords, SetWhatTheySay) {
  using testing::ElementsAre;
  EXPECT_THAT(RunOptionWords("views", 12), ElementsAre("--views", "12"));
  EXPECT_THAT(RunOptionWords("report", false), ElementsAre("--no-report"));
  EXPECT_THAT(RunOptionWords("eval", true), ElementsAre("--eval"));
  EXPECT_THAT(RunOptionWords("ssim-weight", 0.25), ElementsAre("--set", "ssim-weight=0.25"));
  EXPECT_THAT(RunOptionWords("init-planes", false), ElementsAre("--set", "init-planes=false"));
  EXPECT_EQ(RunOptionShown("views"), "--views");
  EXPECT_EQ(RunOptionShown("ssim-weight"), "--set ssim-weight");
}

TEST(SetRunOptions, NamesWhatDoesNotFit) {
  RunOptions options;
  const auto message = [&](const json& values) {
    return MessageOf<UsageError>([&] { SetRunOptions(values, UnknownOption::kError, &options); });
  };
  EXPECT_THAT(message({{"iterationz", 5}}), HasSubstr("no option --iterationz; did you mean 'iterations'?"));
  EXPECT_THAT(message({{"views", "many"}}), HasSubstr("--views is 'many', must be a whole number"));
  EXPECT_THAT(message({{"init", "thick"}}), HasSubstr("--init is 'thick', must be one of"));
  EXPECT_THAT(message({{"views", nullptr}}), HasSubstr("--views is null"));
  SetRunOptions({{"iterationz", 5}}, UnknownOption::kIgnored, &options);
}

}  // namespace
}  // namespace oraclegs
