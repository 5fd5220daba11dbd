#include "oraclegs/networks/aliked/keypoints.h"

#include "networks/aliked/fixture.h"

namespace oraclegs::aliked {
namespace {

TEST(FindKeypoints, MatchTheReference) {
  const SafetensorsFile file = OpenGolden(kGolden);
  const Tensor expected = GoldenTensor(file, "keypoints"), scores = GoldenTensor(file, "scores");
  const auto found = FindKeypoints(GoldenFloat(file, "score_map"),
                                   {.min_score = Number(file, "threshold"), .max_keypoints = Count(file, "limit")});
  ASSERT_EQ(static_cast<int64_t>(found.size()), expected.size(0));
  for (int64_t i = 0; i < expected.size(0); ++i) {
    const Keypoint& keypoint = found[static_cast<size_t>(i)];
    EXPECT_NEAR(keypoint.place.x(), expected[i][0].item<float>(), 1e-4) << i;
    EXPECT_NEAR(keypoint.place.y(), expected[i][1].item<float>(), 1e-4) << i;
    EXPECT_NEAR(keypoint.score, scores[i].item<float>(), 1e-5) << i;
  }
}

Tensor Bump(double x, double y) {
  Tensor scores = torch::full({20, 30}, 0.1f);
  for (int64_t row = 0; row < 20; ++row) {
    for (int64_t column = 0; column < 30; ++column) {
      const double square = (static_cast<double>(column) - x) * (static_cast<double>(column) - x) +
                            (static_cast<double>(row) - y) * (static_cast<double>(row) - y);
      scores[row][column] += 0.8 * std::exp(-square / 2);
    }
  }
  return scores;
}

TEST(FindKeypoints, LieBetweenThePixels) {
  const auto found = FindKeypoints(Bump(12.3, 7.8), {});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].place.x(), 12.2, 0.1);  // the mean is drawn to the pixels' centers
  EXPECT_NEAR(found[0].place.y(), 7.9, 0.1);
  EXPECT_GT(found[0].score, 0.75);
}

TEST(FindKeypoints, NearTheBorderOrFaintAreNone) {
  EXPECT_TRUE(FindKeypoints(Bump(1, 7), {}).empty());
  EXPECT_TRUE(FindKeypoints(Bump(28, 7), {}).empty());
  EXPECT_TRUE(FindKeypoints(Bump(12, 18), {}).empty());
  EXPECT_TRUE(FindKeypoints(Bump(12, 7), {.min_score = 0.95}).empty());
  EXPECT_TRUE(FindKeypoints(torch::rand({4, 4}), {}).empty());
}

TEST(FindKeypoints, SuppressWhatIsBesideThem) {
  Tensor scores = torch::full({20, 30}, 0.1f);
  scores[10][10] = 0.9, scores[10][12] = 0.8, scores[10][14] = 0.7, scores[10][20] = 0.6;
  const auto found = FindKeypoints(scores, {});
  ASSERT_EQ(found.size(), 3u) << "0.8 falls to 0.9, and 0.7 is then a maximum";
  EXPECT_NEAR(found[0].place.x(), 10.5, 0.2) << "drawn to its neighbor";
  EXPECT_NEAR(found[1].place.x(), 12.6, 0.2) << "drawn to a higher one";
  EXPECT_NEAR(found[2].place.x(), 20, 0.1);
  const auto best = FindKeypoints(scores, {.max_keypoints = 1});
  ASSERT_EQ(best.size(), 1u);
  EXPECT_EQ(best[0].place, found[0].place);
}

}  // namespace
}  // namespace oraclegs::aliked
