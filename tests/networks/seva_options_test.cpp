#include "oraclegs/networks/seva_options.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

namespace oraclegs {
namespace {

TEST(SevaOptions, DefaultsAreThePapers) {
  const nlohmann::json json = OptionsToJson(SevaOptions());
  EXPECT_EQ(json.at("seva-frames"), 80);
  EXPECT_EQ(json.at("seva-chunking"), "nearest-gt");
  EXPECT_EQ(json.at("seva-first-chunking"), "gt-nearest");
  EXPECT_EQ(json.at("seva-guider"), "multi-view");
  EXPECT_EQ(json.at("seva-halves"), "auto");
  EXPECT_EQ(json.at("seva-precision"), "float32");
  EXPECT_EQ(json.at("seva-memory"), "auto");
}

TEST(SevaOptions, AreCheckedAgainstTheirRanges) {
  SevaOptions options;
  EXPECT_NO_THROW(CheckOptions(options));
  options.memory = 2.5;
  EXPECT_NO_THROW(CheckOptions(options));
  options.passes = 3;
  EXPECT_THROW(CheckOptions(options), UsageError);
}

}  // namespace
}  // namespace oraclegs
