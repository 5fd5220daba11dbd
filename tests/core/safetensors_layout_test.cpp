#include "oraclegs/core/safetensors_layout.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "oraclegs/core/safetensors.h"

namespace oraclegs {
namespace {

using testing::ElementsAre;

constexpr int64_t kMost = std::numeric_limits<int64_t>::max();

TEST(ElementBytes, KnowsTheTypesOfTheFormat) {
  EXPECT_EQ(ElementBytes("F32"), 4u);
  EXPECT_EQ(ElementBytes("BF16"), 2u);
  EXPECT_EQ(ElementBytes("BOOL"), 1u);
  EXPECT_EQ(ElementBytes("C64"), std::nullopt);
}

TEST(TensorBytes, RefusesOverflowAndNegativeSizes) {
  EXPECT_EQ(TensorBytes({2, 3}, 4), 24u);
  EXPECT_EQ(TensorBytes({}, 8), 8u);
  EXPECT_EQ(TensorBytes({0, kMost}, 8), 0u);
  EXPECT_EQ(TensorBytes({kMost}, 1), static_cast<uint64_t>(kMost));
  EXPECT_EQ(TensorBytes({kMost}, 2), std::nullopt);
  EXPECT_EQ(TensorBytes({int64_t{1} << 32, int64_t{1} << 31}, 1), std::nullopt);
  EXPECT_EQ(TensorBytes({-1}, 1), std::nullopt);
}

TEST(LayOutSafetensors, PutsWideElementsFirst) {
  const SafetensorsLayout layout =
      LayOutSafetensors({{"a", {"U8", {3}}}, {"b", {"F64", {1}}}, {"c", {"U8", {2}}}}, {{"k", "v"}});
  EXPECT_THAT(layout.order, ElementsAre("b", "a", "c"));
  EXPECT_EQ(layout.data_bytes, 13u);
  EXPECT_EQ(layout.beginning.size() % 8, 0u);
  const SafetensorsFile file = SafetensorsFile::Parse(layout.beginning + "12345678abcde", "f");
  EXPECT_EQ(file.Get("a").bytes, "abc");
  EXPECT_EQ(file.Get("c").bytes, "de");
  EXPECT_EQ(file.metadata().at("k"), "v");
}

TEST(LayOutSafetensors, RefusesWhatTheFormatCannotHold) {
  for (const auto& [name, tensor] : std::map<std::string, TensorLayout>{{"type", {"C64", {1}}},
                                                                        {"size", {"U8", {-1}}},
                                                                        {"large", {"F64", {kMost}}},
                                                                        {"\xff", {"U8", {1}}},
                                                                        {"__metadata__", {"U8", {1}}}}) {
    EXPECT_THROW(LayOutSafetensors({{name, tensor}}, {}), std::logic_error) << name;
  }
  EXPECT_THROW(LayOutSafetensors({{"a", {"U8", {kMost}}}, {"b", {"U8", {1}}}}, {}), std::logic_error);
}

}  // namespace
}  // namespace oraclegs
