#include "oraclegs/depth/monocular.h"

#include <gtest/gtest.h>

#include <cmath>

#include "depth/surfaces.h"

namespace oraclegs {
namespace {

/// A view of a plane. Stereo knows its depth except for a square in the middle; a network guesses all of it, in a unit
/// of its own and distorted.
class MonocularTest : public testing::Test {
 protected:
  void SetUp() override {
    truth = TrueDepth(kSlanted.Take(CameraAt({0, 0.25, -4}, {0, 0, 0}, 96, 72), "a.jpg"), kSlanted, 0.9f);
    stereo = truth;
    guess = {96, 72, {}};
    for (int i = 0; i < 96 * 72; ++i) {
      const int x = i % 96, y = i / 96;
      const float bend = 1 + 0.15f * std::sin(0.05f * static_cast<float>(x + y));
      guess.values.push_back((truth.inv_depth[static_cast<size_t>(i)] * bend - 0.05f) / 4);
      if (!IsBlind(i)) continue;
      stereo.confidence[static_cast<size_t>(i)] = 0.2f;
      stereo.inv_depth[static_cast<size_t>(i)] *= 3;
    }
    for (int i = 0; i < 40; ++i) {
      const size_t at = static_cast<size_t>(i) * 167 % (96 * 72);
      known.push_back({static_cast<double>(at % 96) + 0.5, static_cast<double>(at / 96) + 0.5,
                       static_cast<double>(truth.inv_depth[at])});
    }
    alignment = Align(guess, truth.camera, known, {});
  }
  static bool IsBlind(int i) { return i % 96 >= 30 && i % 96 < 66 && i / 96 >= 22 && i / 96 < 50; }

  /// Mean relative error where stereo has no depth.
  double ErrorOf(const DepthMap& map) const {
    double sum = 0;
    int n = 0;
    for (int i = 0; i < 96 * 72; ++i) {
      const auto at = static_cast<size_t>(i);
      if (!IsBlind(i)) continue;
      sum += std::abs(static_cast<double>(map.inv_depth[at] / truth.inv_depth[at]) - 1), ++n;
    }
    return sum / n;
  }

  DepthMap truth, stereo;
  RelativeDepth guess;
  std::vector<KnownDepth> known;
  Alignment alignment;
};

TEST_F(MonocularTest, FusedKeepsStereoAndCorrectsNetwork) {
  const MonocularDepth fused = FusedDepth(stereo, guess, alignment, known, {});
  const MonocularDepth alone = AlignedDepth(truth, guess, alignment, known, {});
  EXPECT_TRUE(fused.map.monocular);
  EXPECT_EQ(fused.map.name, "a.jpg");
  for (int i = 0; i < 96 * 72; ++i) {
    const auto at = static_cast<size_t>(i);
    if (IsBlind(i)) {
      EXPECT_GT(fused.map.confidence[at], 0.3f);
      EXPECT_LT(fused.map.confidence[at], kConfident);
      EXPECT_GT(fused.map.normals[at].dot(truth.normals[at]), 0.8f) << i;
    } else {
      EXPECT_EQ(fused.map.inv_depth[at], stereo.inv_depth[at]);
      EXPECT_EQ(fused.map.confidence[at], stereo.confidence[at]);
      EXPECT_EQ(fused.map.normals[at], stereo.normals[at]);
    }
  }
  EXPECT_GT(fused.right, 0.8);
  EXPECT_LT(ErrorOf(fused.map), 0.03);
  EXPECT_GT(ErrorOf(alone.map), 2 * ErrorOf(fused.map)) << "one scale and offset do not do";
}

TEST_F(MonocularTest, FusedIsUnconfidentWhereNetworkIsWrong) {
  for (int i = 0; i < 96 * 72; ++i) {  // what stereo is sure of jumps about; the guess is smooth
    const int block = (i % 96 / 3) * 7919 + (i / 96 / 3) * 104729;
    stereo.inv_depth[static_cast<size_t>(i)] = 0.1f + 0.005f * static_cast<float>(block % 97);
  }
  const MonocularDepth fused = FusedDepth(stereo, guess, alignment, known, {});
  EXPECT_LT(fused.right, 0.4);
  for (int i = 0; i < 96 * 72; ++i) {
    if (!IsBlind(i)) continue;
    ASSERT_LE(fused.map.confidence[static_cast<size_t>(i)], static_cast<float>(fused.right)) << i;
  }
}

TEST_F(MonocularTest, FusedKeepsAlignmentWithFewSamples) {
  for (size_t i = 0; i < stereo.size(); ++i) {
    if (i >= 100) stereo.confidence[i] = 0;
  }
  const MonocularDepth fused = FusedDepth(stereo, guess, alignment, known, {});
  const MonocularDepth alone = AlignedDepth(truth, guess, alignment, known, {});
  EXPECT_EQ(fused.right, alone.right);
  EXPECT_EQ(fused.map.inv_depth[5000], alone.map.inv_depth[5000]);
}

TEST_F(MonocularTest, AlignedConfidenceIsShareOfRightPoints) {
  const MonocularDepth alone = AlignedDepth(truth, guess, alignment, known, {});
  int right = 0;
  for (const KnownDepth& k : known) {
    const double w = alignment.At(SampleAt(guess, k.x - 0.5, k.y - 0.5));
    right += std::abs(w / k.inv_depth - 1) < 0.05 ? 1 : 0;
  }
  EXPECT_DOUBLE_EQ(alone.right, right / 40.0);
  EXPECT_FLOAT_EQ(alone.map.confidence[2000], static_cast<float>(alone.right));
  EXPECT_EQ(alone.map.camera.fx, truth.camera.fx);
}

TEST_F(MonocularTest, ImpossibleDepthIsUnknown) {
  guess.values[100] = -10;  // beyond infinity
  guess.values[200] = 10;   // before everything
  AllowedPixels allowed(truth.size(), 1);
  allowed[300] = 0;
  const DepthMap map = AlignedDepth(truth, guess, alignment, known, allowed).map;
  for (const size_t i : {100u, 200u, 300u}) {
    EXPECT_EQ(map.inv_depth[i], 0) << i;
    EXPECT_EQ(map.confidence[i], 0) << i;
    EXPECT_TRUE(map.normals[i].isZero()) << i;
  }
  EXPECT_GT(map.confidence[301], 0);
  const DepthMap none = AlignedDepth(truth, guess, {}, {}, {}).map;
  EXPECT_EQ(ConfidentShare(none), 0);
  EXPECT_EQ(none.inv_depth, std::vector<float>(truth.size(), 0));
}

TEST_F(MonocularTest, WholeDepthHasNearPixelsAndMapsThatFitNowhere) {
  guess.values[100] = -10, guess.values[200] = 10;
  AllowedPixels allowed(truth.size(), 1);
  allowed[300] = 0;
  const DepthMap map = WholeDepth(truth, guess, alignment, known, allowed).map;
  EXPECT_EQ(map.inv_depth[100], 0) << "beyond infinity";
  EXPECT_NEAR(map.inv_depth[200], alignment.At(10), 1e-4);
  EXPECT_EQ(map.confidence[300], 0);
  EXPECT_EQ(map.inv_depth[301], AlignedDepth(truth, guess, alignment, known, allowed).map.inv_depth[301]);
  const std::vector<KnownDepth> wrong = {{10.5, 10.5, 99}};
  EXPECT_EQ(AlignedDepth(truth, guess, alignment, wrong, {}).map.confidence[301], 0);
  const MonocularDepth whole = WholeDepth(truth, guess, alignment, wrong, {});
  EXPECT_EQ(whole.right, 0);
  EXPECT_NEAR(whole.map.confidence[301], kLeastOfWhole, 1e-6);
}

TEST_F(MonocularTest, ConfidentDepthsComeFromStereo) {
  const std::vector<KnownDepth> confident = ConfidentDepths(stereo);
  EXPECT_GT(confident.size(), 1000u);
  EXPECT_LE(confident.size(), 5000u);
  for (const KnownDepth& k : confident) {
    const int i = static_cast<int>(k.y) * 96 + static_cast<int>(k.x);
    EXPECT_FALSE(IsBlind(i));
    EXPECT_EQ(static_cast<float>(k.inv_depth), truth.inv_depth[static_cast<size_t>(i)]);
  }
}

}  // namespace
}  // namespace oraclegs
