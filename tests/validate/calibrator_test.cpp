#include "oraclegs/validate/calibrator.h"

#include <gtest/gtest.h>

#include "oraclegs/core/error.h"

namespace oraclegs {
namespace {

/// Two kinds of pixels: of feature 0 with this error, of feature 1 without any.
PixelSamples Samples(float error) {
  PixelSamples samples;
  samples.columns = 1;
  for (int i = 0; i < 400; ++i) {
    samples.rows.push_back(static_cast<float>(i % 2));
    samples.errors.push_back(i % 2 == 0 ? error : 0.f);
  }
  return samples;
}

float Confidence(const PixelModel& model, float feature) { return model.level(model.order(&feature)); }

TEST(Calibrator, MapsFeaturesToTheSimilarityOfSuchPixels) {
  Calibrator calibrator;
  calibrator.Fit({{"warp", Samples(0.08f)}});
  EXPECT_NEAR(Confidence(calibrator.ModelOf("warp"), 0), std::exp(-1.f), 1e-3f);
  EXPECT_NEAR(Confidence(calibrator.ModelOf("warp"), 1), 1, 1e-3f);
}

TEST(Calibrator, KeepsTheRegressionsAnswerWithoutALevel) {
  Calibrator calibrator(LevelRule::kAsIs);
  calibrator.Fit({{"warp", Samples(0.08f)}});
  const PixelModel& model = calibrator.ModelOf("warp");
  const float feature = 0;
  EXPECT_EQ(Confidence(model, feature), model.order(&feature));
  EXPECT_LT(Confidence(model, 0), 0.3f) << "the mean of a coarse and a fine similarity";
}

TEST(Calibrator, HasAModelForEachProposerAndOneForOthers) {
  Calibrator calibrator;
  EXPECT_FALSE(calibrator.fitted());
  calibrator.Fit({{"good", Samples(0.01f)}, {"bad", Samples(0.5f)}});
  EXPECT_GT(Confidence(calibrator.ModelOf("good"), 0), 0.9f);
  EXPECT_LT(Confidence(calibrator.ModelOf("bad"), 0), 0.1f);
  const float between = Confidence(calibrator.ModelOf("folder"), 0);
  EXPECT_GT(between, 0.2f);
  EXPECT_LT(between, 0.8f);
  calibrator.Fit({{"mixed", Samples(0.f)}});
  EXPECT_EQ(Confidence(calibrator.ModelOf("folder"), 0), between) << "of the first fit";
}

TEST(Calibrator, NeedsSamples) {
  Calibrator calibrator;
  EXPECT_THROW(calibrator.Fit({}), InputError);
  EXPECT_THROW(calibrator.Fit({{"warp", {}}}), InputError);
  calibrator.Fit({{"warp", Samples(0.1f)}, {"proxies", {}}});
  EXPECT_EQ(Confidence(calibrator.ModelOf("proxies"), 0), Confidence(calibrator.ModelOf("warp"), 0));
}

TEST(Isotonic, IsTheIdentityBeforeItHasLearned) {
  EXPECT_EQ(Isotonic()(0.3f), 0.3f);
  EXPECT_EQ(Isotonic::Fit({})(0.7f), 0.7f);
}

TEST(Isotonic, PoolsWhatFalls) {
  // By hand: 1 and 0 at x = 2, 3 pool to 0.5.
  const Isotonic map = Isotonic::Fit({{3.f, 0.f}, {1.f, 0.f}, {2.f, 1.f}, {4.f, 1.f}});
  EXPECT_FLOAT_EQ(map(1.f), 0.f);
  EXPECT_FLOAT_EQ(map(2.5f), 0.5f);
  EXPECT_FLOAT_EQ(map(4.f), 1.f);
  EXPECT_FLOAT_EQ(map(9.f), 1.f);
  EXPECT_FLOAT_EQ(map(-9.f), 0.f);
  EXPECT_FLOAT_EQ(map(1.75f), 0.25f);  // between the middles of two steps
}

TEST(Isotonic, NeverFalls) {
  std::vector<std::pair<float, float>> samples;
  for (int i = 0; i < 5000; ++i) {
    const float x = static_cast<float>(i * 7919 % 5000) / 5000;
    samples.emplace_back(x, x * x + (i % 2 == 0 ? 0.3f : -0.3f));
  }
  const Isotonic map = Isotonic::Fit(samples);
  float before = -1;
  for (int i = 0; i <= 100; ++i) {
    const float y = map(static_cast<float>(i) / 100);
    EXPECT_GE(y, before);
    before = y;
  }
  EXPECT_NEAR(map(0.5f), 0.25f, 0.05f);
}

TEST(Isotonic, TakesOneLevelForOneConfidence) {
  const Isotonic map = Isotonic::Fit({{0.5f, 0.f}, {0.5f, 1.f}, {0.5f, 0.5f}});
  EXPECT_FLOAT_EQ(map(0.1f), 0.5f);
  EXPECT_FLOAT_EQ(map(0.9f), 0.5f);
}

}  // namespace
}  // namespace oraclegs
