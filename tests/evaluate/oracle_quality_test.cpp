#include "oraclegs/evaluate/oracle_quality.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "oraclegs/core/error.h"
#include "oraclegs/core/rng.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;

OracleQuality Quality(const std::vector<float>& error, const std::vector<float>& confidence) {
  return OracleQuality::FromPixels(error, confidence);
}

/// Values 0, 1/n, ... (n-1)/n.
std::vector<float> Ramp(int n) {
  std::vector<float> ramp(n);
  for (int i = 0; i < n; ++i) ramp[i] = static_cast<float>(i) / static_cast<float>(n);
  return ramp;
}

std::vector<float> Complement(std::vector<float> values) {
  for (float& value : values) value = 1 - value;
  return values;
}

TEST(OracleQualityTest, APerfectOrder) {
  const std::vector<float> error = Ramp(1000);
  const OracleQuality q = Quality(error, Complement(error));
  EXPECT_EQ(q.pixels, 1000);
  EXPECT_NEAR(q.mean_error, 0.4995, 1e-6);
  EXPECT_NEAR(q.median_error, 0.499, 1e-6);
  EXPECT_NEAR(q.ause, 0, 1e-12);
  // Errors e in [0, 1): of the best m the mean is m/2, its mean over m is 1/4, half of the mean error.
  EXPECT_NEAR(q.ause_random, 0.5, 1e-3);
  EXPECT_NEAR(q.ause_ratio, 0, 1e-12);
  EXPECT_NEAR(q.spearman, 1, 1e-12);
  EXPECT_EQ(q.auroc_above_median, 1);
  EXPECT_EQ(q.auroc_large_error, 1);
  EXPECT_TRUE(q.monotone);
}

TEST(OracleQualityTest, AnInvertedOrder) {
  const std::vector<float> error = Ramp(1000);
  const OracleQuality q = Quality(error, error);
  // Of the worst m of n the mean is 1 - m/2n, its mean over m is 3/4.
  EXPECT_NEAR(q.ause, 1, 2e-3);
  EXPECT_NEAR(q.ause_ratio, 2, 1e-3);
  EXPECT_NEAR(q.spearman, -1, 1e-12);
  EXPECT_EQ(q.auroc_above_median, 0);
  EXPECT_EQ(q.auroc_large_error, 0);
  EXPECT_FALSE(q.monotone);
}

TEST(OracleQualityTest, AConstantConfidenceIsRandomOrder) {
  const OracleQuality q = Quality(Ramp(1000), std::vector<float>(1000, 0.75f));
  EXPECT_NEAR(q.ause, q.ause_random, 1e-12);
  EXPECT_NEAR(q.ause_ratio, 1, 1e-12);
  EXPECT_EQ(q.spearman, 0);
  EXPECT_EQ(q.auroc_above_median, 0.5);
  EXPECT_EQ(q.auroc_large_error, 0.5);
  ASSERT_EQ(q.reliability.size(), 1u);
  EXPECT_EQ(q.reliability[0].confidence, 0.75);
  EXPECT_EQ(q.reliability[0].share, 1);
  EXPECT_NEAR(q.reliability[0].error, q.mean_error, 1e-12);
  EXPECT_FALSE(q.monotone);  // nothing to compare
}

TEST(OracleQualityTest, WithoutDifferencesOfErrorThereIsNothingToTell) {
  for (const float e : {0.f, 0.3f}) {
    const OracleQuality q = Quality({e, e, e}, {0, 0.5f, 1});
    EXPECT_NEAR(q.ause, 0, 1e-12);
    EXPECT_TRUE(std::isnan(q.ause_ratio));
    EXPECT_EQ(q.spearman, 0);
    EXPECT_TRUE(std::isnan(q.auroc_above_median));
    EXPECT_TRUE(std::isnan(q.auroc_large_error));
    const nlohmann::json json = ToJson(q);
    EXPECT_TRUE(json.at("ause_ratio").is_null());
    EXPECT_TRUE(json.at("auroc_above_median").is_null());
    EXPECT_TRUE(json.at("auroc_large_error").is_null());
  }
}

TEST(OracleQualityTest, FourPixelsByHand) {
  // Least sure first: .4, then .2 and .0 in either order, then .1.
  const OracleQuality q = Quality({0.2f, 0.4f, 0, 0.1f}, {0.5f, 0.1f, 0.5f, 0.9f});
  EXPECT_NEAR(q.mean_error, 0.175, 1e-7);
  const double curve = (0.7 / 4 + 0.3 / 3 + 0.2 / 2 + 0.1) / 4, ideal = (0.7 / 4 + 0.3 / 3 + 0.1 / 2 + 0) / 4;
  EXPECT_NEAR(q.ause, (curve - ideal) / 0.175, 1e-7);
  EXPECT_NEAR(q.ause_random, (0.175 - ideal) / 0.175, 1e-7);
  EXPECT_NEAR(q.median_error, 0.1, 1e-7);
  // Errors above .1 are .2 (confidence .5) and .4 (.1); the others have .5 and .9.
  EXPECT_EQ(q.auroc_above_median, 3.5 / 4);
  EXPECT_EQ(q.auroc_large_error, 3.5 / 4);
  // Ranks of confidence 2.5 1 2.5 4, of -error 2 1 4 3: deviations 0 -1.5 0 1.5 and -.5 -1.5 1.5 .5.
  EXPECT_NEAR(q.spearman, 3 / std::sqrt(4.5 * 5), 1e-12);
}

/// Checks each number against its definition, with 8-bit confidence, where ties are common.
TEST(OracleQualityTest, MatchesBruteForce) {
  for (uint64_t seed = 0; seed < 5; ++seed) {
    Rng rng(seed, RandomStream::kViewOrder);
    constexpr int kCount = 60;
    std::vector<float> error(kCount), confidence(kCount);
    for (int i = 0; i < kCount; ++i) {
      error[i] = static_cast<float>(rng.Index(20)) / 80.f;
      confidence[i] = static_cast<float>(std::min<int64_t>(255, rng.Index(8) * 30 + (error[i] < 0.1f ? 45 : 0))) / 255;
    }
    const OracleQuality q = Quality(error, confidence);
    // The mean over many random orders among ties is what the expected value stands for.
    std::vector<int> order(kCount);
    std::iota(order.begin(), order.end(), 0);
    const auto area = [&](const std::vector<int>& removed) {
      double sum = 0;
      for (int k = 0; k < kCount; ++k) {
        double rest = 0;
        for (int j = k; j < kCount; ++j) rest += static_cast<double>(error[removed[j]]);
        sum += rest / (kCount - k);
      }
      return sum / kCount;
    };
    std::sort(order.begin(), order.end(), [&](int a, int b) { return error[a] > error[b]; });
    const double ideal = area(order);
    double mean_area = 0;
    constexpr int kShuffles = 4000;
    for (int s = 0; s < kShuffles; ++s) {
      for (int i = kCount - 1; i > 0; --i) std::swap(order[i], order[rng.Index(i + 1)]);
      std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return confidence[a] < confidence[b]; });
      mean_area += area(order) / kShuffles;
    }
    EXPECT_NEAR(q.ause, (mean_area - ideal) / q.mean_error, 0.01);
    EXPECT_NEAR(q.ause_ratio, q.ause / q.ause_random, 1e-12);

    const auto auroc = [&](double threshold) {
      double wins = 0, pairs = 0;
      for (int i = 0; i < kCount; ++i) {
        for (int j = 0; j < kCount; ++j) {
          if (!(static_cast<double>(error[i]) > threshold) || static_cast<double>(error[j]) > threshold) continue;
          ++pairs;
          wins += confidence[i] < confidence[j] ? 1 : confidence[i] == confidence[j] ? 0.5 : 0;
        }
      }
      return wins / pairs;
    };
    EXPECT_NEAR(q.auroc_above_median, auroc(q.median_error), 1e-12);
    EXPECT_NEAR(q.auroc_large_error, auroc(static_cast<double>(kLargeError)), 1e-12);

    const auto ranks = [&](const std::vector<float>& values, float sign) {
      std::vector<double> result(kCount);
      for (int i = 0; i < kCount; ++i) {
        double below = 0, equal = 0;
        for (int j = 0; j < kCount; ++j) {
          below += sign * values[j] < sign * values[i];
          equal += values[j] == values[i];
        }
        result[i] = below + (equal + 1) / 2;
      }
      return result;
    };
    const std::vector<double> a = ranks(confidence, 1), b = ranks(error, -1);
    double aa = 0, bb = 0, ab = 0;
    const double middle = (kCount + 1) / 2.0;
    for (int i = 0; i < kCount; ++i) {
      aa += (a[i] - middle) * (a[i] - middle), bb += (b[i] - middle) * (b[i] - middle);
      ab += (a[i] - middle) * (b[i] - middle);
    }
    EXPECT_NEAR(q.spearman, ab / std::sqrt(aa * bb), 1e-12);
  }
}

TEST(OracleQualityTest, ReliabilityIsOfTenths) {
  const OracleQuality q = Quality({0.04f, 0.08f, 0.5f, 0}, {0.91f, 0.99f, 0.05f, 1});
  ASSERT_EQ(q.reliability.size(), 2u);
  const ReliabilityBin &low = q.reliability[0], &high = q.reliability[1];
  EXPECT_EQ(low.from, 0);
  EXPECT_EQ(low.to, 0.1);
  EXPECT_NEAR(low.confidence, 0.05, 1e-7);
  EXPECT_NEAR(low.error, 0.5, 1e-7);
  EXPECT_EQ(low.share, 0.25);
  EXPECT_EQ(high.from, 0.9);
  EXPECT_EQ(high.to, 1);
  EXPECT_NEAR(high.confidence, (0.91 + 0.99 + 1) / 3, 1e-7);
  EXPECT_NEAR(high.error, 0.04, 1e-7);
  EXPECT_NEAR(high.similarity, (std::exp(-0.25) + std::exp(-1.) + 1) / 3, 1e-6);
  EXPECT_EQ(high.share, 0.75);
  EXPECT_TRUE(q.monotone);
  // Similarities are 0 (e^-39) and, in the high bin, .7155.
  EXPECT_NEAR(q.calibration_error, 0.25 * 0.05 + 0.75 * std::abs(2.9 / 3 - (std::exp(-0.25) + std::exp(-1.) + 1) / 3),
              1e-6);
}

/// `count` pixels of each (confidence, error) pair.
OracleQuality Steps(const std::vector<std::array<float, 2>>& steps, const std::vector<int>& counts) {
  std::vector<float> error, confidence;
  for (size_t k = 0; k < steps.size(); ++k) {
    confidence.insert(confidence.end(), counts[k], steps[k][0]);
    error.insert(error.end(), counts[k], steps[k][1]);
  }
  return Quality(error, confidence);
}

TEST(OracleQualityTest, SmallBinsDoNotBreakMonotony) {
  const std::vector<std::array<float, 2>> steps = {{0.05f, 0.4f}, {0.45f, 0.01f}, {0.55f, 0.2f}, {0.95f, 0.05f}};
  EXPECT_FALSE(Steps(steps, {500, 10, 500, 500}).monotone);
  const OracleQuality q = Steps(steps, {500, 5, 500, 500});
  EXPECT_TRUE(q.monotone);
  EXPECT_EQ(q.reliability.size(), 4u);  // which shows it nevertheless
  EXPECT_FALSE(Steps({{0.05f, 0.4f}, {0.95f, 0.4f}}, {10, 10}).monotone);
  // At the ends there is one neighbor only.
  EXPECT_TRUE(Steps({{0.05f, 0.f}, {0.15f, 0.4f}, {0.85f, 0.1f}, {0.95f, 0.9f}}, {1, 500, 500, 1}).monotone);
  // What is small even together with its neighbor is joined again.
  EXPECT_TRUE(Steps({{0.05f, 0.f}, {0.15f, 0.1f}, {0.25f, 0.4f}, {0.95f, 0.1f}}, {1, 2, 500, 500}).monotone);
}

TEST(OracleQualityTest, JsonHasTheFieldsByName) {
  const nlohmann::json json = ToJson(Quality({0.2f, 0.4f, 0, 0.05f}, {0.5f, 0.1f, 0.5f, 0.9f}));
  for (const char* name : {"pixels", "mean_error", "ause", "ause_random", "ause_ratio", "spearman", "median_error",
                           "auroc_above_median", "auroc_large_error", "calibration_error"}) {
    EXPECT_TRUE(json.at(name).is_number()) << name;
  }
  EXPECT_TRUE(json.at("monotone").is_boolean());
  ASSERT_EQ(json.at("reliability").size(), 3u);
  for (const char* name : {"from", "to", "confidence", "error", "similarity", "share"}) {
    EXPECT_TRUE(json.at("reliability")[0].at(name).is_number()) << name;
  }
}

TEST(OracleQualityTest, RefusesWhatIsNoPixel) {
  const auto message = [](const std::vector<float>& error, const std::vector<float>& confidence) -> std::string {
    try {
      Quality(error, confidence);
    } catch (const ShapeError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_THAT(message({}, {}), HasSubstr("0 errors and 0 confidences"));
  EXPECT_THAT(message({0, 0}, {1}), HasSubstr("2 errors and 1 confidences"));
  EXPECT_THAT(message({0, -0.5f}, {1, 1}), HasSubstr("the error of pixel 1 is -0.5"));
  EXPECT_THAT(message({std::nanf("")}, {1}), HasSubstr("the error of pixel 0 is nan"));
  EXPECT_THAT(message({INFINITY}, {1}), HasSubstr("the error of pixel 0 is inf"));
  EXPECT_THAT(message({0}, {1.5f}), HasSubstr("the confidence of pixel 0 is 1.5"));
  EXPECT_THAT(message({0}, {std::nanf("")}), HasSubstr("the confidence of pixel 0 is nan"));
}

}  // namespace
}  // namespace oraclegs
