#include "oraclegs/weights/registry.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "oraclegs/core/error.h"
#include "oraclegs/core/sha256.h"
#include "oraclegs/weights/parameter_list.h"

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;
using testing::ThrowsMessage;

TEST(AllWeights, AreComplete) {
  std::set<std::string> names;
  for (const WeightsInfo& model : AllWeights()) {
    EXPECT_TRUE(names.insert(model.name).second) << model.name;
    EXPECT_FALSE(model.purpose.empty() || model.license.empty() || model.files.empty()) << model.name;
    EXPECT_THAT(model.license_page, StartsWith("https://")) << model.name;
    EXPECT_FALSE(ParametersOf(model.parameters).tensors.empty()) << model.name;
    uint64_t bytes = 0;
    for (const PublishedFile& file : model.files) {
      EXPECT_THAT(file.url, StartsWith("https://"));
      EXPECT_TRUE(file.sha256.empty() || IsSha256(file.sha256)) << file.url;
      bytes += file.bytes;
    }
    EXPECT_GT(model.download_bytes, 0u);
    EXPECT_LE(bytes, model.download_bytes);
    // What is on the hub is asked for at a revision, which never changes.
    for (const PublishedFile& file : model.files) {
      if (!file.url.starts_with(kHuggingFace)) continue;
      const size_t at = file.url.find("/resolve/");
      ASSERT_NE(at, std::string::npos);
      EXPECT_EQ(file.url.find_first_not_of("0123456789abcdef", at + 9), at + 9 + 40) << file.url;
    }
    // A file that is used as it is published must be one safetensors file.
    if (!model.convert) {
      EXPECT_EQ(model.files.size(), 1u);
      EXPECT_TRUE(model.files[0].url.ends_with(".safetensors"));
    }
  }
}

TEST(AllWeights, MarksNonCommercialOnes) {
  std::set<std::string> restricted;
  for (const WeightsInfo& model : AllWeights()) {
    if (model.non_commercial) restricted.insert(model.name);
  }
  EXPECT_EQ(restricted,
            (std::set<std::string>{"depth-anything-v2-base", "depth-anything-v2-large", "seva", "seva-1.0", "vggt"}));
  EXPECT_THAT(WeightsNamed("seva").restriction, HasSubstr("images that the network makes"));
  EXPECT_EQ(WeightsNamed("depth-anything-v2-small").license, "Apache-2.0");
}

TEST(WeightsNamed, ListsKnownNames) {
  EXPECT_THAT([] { WeightsNamed("vgt"); },
              ThrowsMessage<UsageError>(
                  AllOf(StartsWith("there is no model 'vgt', only: "), HasSubstr("vggt-commercial, lpips-vgg"))));
}

}  // namespace
}  // namespace oraclegs
