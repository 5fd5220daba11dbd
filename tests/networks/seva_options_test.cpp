#include "oraclegs/networks/seva_options.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

namespace oraclegs {
namespace {

TEST(SevaOptions, DefaultsAreThePapers) {
  const nlohmann::json json = OptionsToJson(SevaOptions());
  EXPECT_EQ(json.at("seva-frames"), 80);
  EXPECT_EQ(json.at("seva-halves"), "auto");
  EXPECT_EQ(json.at("seva-precision"), "float32");
}

TEST(SevaOptions, AreCheckedAgainstTheirRanges) {
  SevaOptions options;
  EXPECT_NO_THROW(CheckOptions(options));
  options.steps = 0;
  EXPECT_THROW(CheckOptions(options), UsageError);
}

}  // namespace
}  // namespace oraclegs
