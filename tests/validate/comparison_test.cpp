#include "oraclegs/validate/comparison.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "oraclegs/core/error.h"

namespace oraclegs {
namespace {

constexpr int kSide = 48;

size_t ComparisonNamed(const char* name) {
  const auto found = std::find_if(kComparisonNames.begin(), kComparisonNames.end(),
                                  [&](const char* other) { return std::strcmp(name, other) == 0; });
  EXPECT_NE(found, kComparisonNames.end());
  return static_cast<size_t>(found - kComparisonNames.begin());
}

ImageF Texture() {
  ImageF image{kSide, kSide, 3, {}};
  for (int i = 0; i < kSide * kSide; ++i) {
    for (int c = 0; c < 3; ++c) image.data.push_back(0.2f + 0.04f * static_cast<float>(i * 37 % 11));
  }
  return image;
}

Comparison InTheMiddle(const ImageF& a, const ImageF& b) { return Compare(a, b)[kSide * kSide / 2 + kSide / 2]; }

TEST(Compare, FindsNothingBetweenEqualImages) {
  const Comparison same = InTheMiddle(Texture(), Texture());
  for (const char* name : {"color", "shift near", "shift wide", "shift wider"}) {
    EXPECT_NEAR(same[ComparisonNamed(name)], std::log(0.005f), 1e-4f) << name;
  }
  for (const char* name : {"structure", "sharpness near", "sharpness wide"}) {
    EXPECT_NEAR(same[ComparisonNamed(name)], 0, 1e-4f) << name;
  }
}

TEST(Compare, TellsAShiftOfToneFromOtherDetails) {
  ImageF brighter = Texture(), reversed = Texture();
  for (float& v : brighter.data) v += 0.1f;
  for (float& v : reversed.data) v = 0.8f - v;  // about the same mean
  const Comparison tone = InTheMiddle(brighter, Texture()), details = InTheMiddle(reversed, Texture());
  EXPECT_NEAR(tone[ComparisonNamed("shift wider")], std::log(0.105f), 0.01f);
  EXPECT_NEAR(tone[ComparisonNamed("structure")], 0, 1e-3f);
  EXPECT_LT(details[ComparisonNamed("shift wider")], std::log(0.02f));
  EXPECT_GT(details[ComparisonNamed("structure")], 1.8f);
}

TEST(Compare, SeesWhatIsBlurred) {
  const ImageF flat{kSide, kSide, 3, std::vector<float>(size_t{3} * kSide * kSide, 0.4f)};
  EXPECT_LT(InTheMiddle(flat, Texture())[ComparisonNamed("sharpness wide")], -2);
  EXPECT_GT(InTheMiddle(Texture(), flat)[ComparisonNamed("sharpness wide")], 2);
}

TEST(Compare, RefusesImagesOfDifferentSizes) {
  EXPECT_THROW(Compare(Texture(), ImageF{1, 1, 3, {0, 0, 0}}), ShapeError);
}

}  // namespace
}  // namespace oraclegs
