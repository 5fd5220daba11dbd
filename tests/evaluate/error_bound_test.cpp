#include "oraclegs/evaluate/error_bound.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "oraclegs/core/error.h"
#include "oraclegs/core/rng.h"

namespace oraclegs {
namespace {

/// `n` pixels of one expected error, whose errors are 1, 2, ... n hundredths of `largest`.
ExpectedErrors Rising(int n, float largest, float expected) {
  ExpectedErrors photo;
  for (int i = 1; i <= n; ++i) {
    photo.error.push_back(largest * static_cast<float>(i) / static_cast<float>(n));
    photo.expected.push_back(expected);
  }
  return photo;
}

TEST(BoundFrom, IsTheErrorThatNineOfTenStayBelow) {
  const ErrorBound bound = BoundFrom({Rising(100, 1, 0.02f), Rising(100, 1, 0.02f), Rising(100, 1, 0.02f)});
  EXPECT_NEAR(bound.below[0], 0.9, 1e-6);
  EXPECT_TRUE(std::isnan(bound.below[1]));
  EXPECT_EQ(bound.photos, 3);
}

TEST(BoundFrom, PhotosWeighTheSameByHoweverManyPixels) {
  // The many pixels of one photo are as one fifth of the weight: the rest decides.
  const ErrorBound bound = BoundFrom({Rising(10000, 0.01f, 0.05f), Rising(10, 1, 0.05f), Rising(10, 1, 0.05f),
                                      Rising(10, 1, 0.05f), Rising(10, 1, 0.05f)});
  EXPECT_NEAR(bound.below[1], 0.9, 1e-6);
}

TEST(BoundFrom, TellsNothingOfTooFewPhotos) {
  const ErrorBound bound = BoundFrom({Rising(100, 1, 0.2f), Rising(100, 1, 0.2f), {}});
  EXPECT_TRUE(std::isnan(bound.below[2]));
  EXPECT_EQ(bound.photos, 2);
  EXPECT_TRUE(ToJson(bound, nullptr)["classes"][2]["below"].is_null());
  EXPECT_THROW(BoundFrom({{{0.1f}, {}}}), ShapeError);
}

TEST(CheckBound, CoversNewPhotosOfTheSameKind) {
  // Errors of a photo share a factor, as photos of a scene do. Another draw of the same is covered by nine tenths.
  Rng random(0, RandomStream::kStandIns, 0);
  const auto draw = [&](int photos) {
    std::vector<ExpectedErrors> all(static_cast<size_t>(photos));
    for (ExpectedErrors& photo : all) {
      const float hard = 0.5f + random.Uniform();
      for (int i = 0; i < 500; ++i) {
        photo.error.push_back(hard * 0.1f * random.Uniform());
        photo.expected.push_back(i % 2 == 0 ? 0.01f : 0.06f);
      }
    }
    return all;
  };
  const ErrorBound bound = BoundFrom(draw(40));
  const BoundCheck check = CheckBound(bound, draw(200));
  EXPECT_NEAR(check.covered[0], 0.9, 0.04);
  EXPECT_NEAR(check.covered[1], 0.9, 0.04);
  EXPECT_TRUE(std::isnan(check.covered[2]));
  EXPECT_DOUBLE_EQ(check.share[0], 0.5);
  const nlohmann::json json = ToJson(bound, &check);
  EXPECT_EQ(json["classes"][0]["covered"], check.covered[0]);
  EXPECT_EQ(json["classes"][1]["pixels"], 0.5);
  EXPECT_FALSE(ToJson(bound, nullptr)["classes"][0].contains("covered"));
}

}  // namespace
}  // namespace oraclegs
