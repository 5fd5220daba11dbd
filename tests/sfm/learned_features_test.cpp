#include "oraclegs/sfm/learned_features.h"

#include <gmock/gmock.h>

#include "oraclegs/core/files.h"
#include "oraclegs/core/rng.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/sfm/colmap_database.h"
#include "support/temp_dir.h"
#include "support/textured_planes.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr int kPoints = 60;

/// Where the views of `scene`, asked for in order, see points of the wall and of the shelf; each point has a descriptor
/// of its own.
FeatureFinder TruthOf(const Scene& scene) {
  return [&scene, view = size_t{0}](const ImageF& rgb) mutable {
    EXPECT_EQ(rgb.channels, 3);
    const SceneView& seen = scene.views.at(view++);
    LearnedFeatures features;
    Rng rng(5, RandomStream::kInitialPoints);
    std::vector<float> descriptors;
    for (int i = 0; i < kPoints; ++i) {
      const bool shelf = i % 2 == 0;
      const Eigen::Vector3d at(rng.Uniform(-.6, .6), rng.Uniform(-.3, .6), shelf ? kShelfDepth : kWallDepth);
      const Eigen::Vector3d point = *seen.cam_from_world * at;
      features.keypoints.emplace_back((point.head<2>() / point.z() * kPlanesFocal).cast<float>() +
                                      Eigen::Vector2f(kPlanesWidth, kPlanesHeight) / 2);
      Eigen::Matrix<float, 16, 1> descriptor;
      for (float& value : descriptor) value = static_cast<float>(rng.Uniform(-1, 1));
      descriptor.normalize();
      descriptors.insert(descriptors.end(), descriptor.begin(), descriptor.end());
    }
    features.descriptors = Buffer<float>::From({kPoints, 16}, std::span<const float>(descriptors));
    return features;
  };
}

/// A workspace with the features and matches that the real colmap found in three views of textured planes.
class LearnedFeaturesTest : public testing::Test {
 protected:
  void SetUp() override {
    colmap.ExtractFeatures("SIMPLE_RADIAL", false);
    colmap.MatchExhaustively();
  }

  const TempDir dir;
  const Scene scene = WriteTexturedPlanes(dir.path(), 3);
  const Listener silent = Silent();
  const ColmapRunner colmap{dir.path(), silent, "register"};
};

TEST_F(LearnedFeaturesTest, AreVerifiedTogetherWithThoseOfSift) {
  const auto features = ReadFeatureCounts(colmap.database());
  const std::vector<MatchedPair> before = ReadMatchedPairs(colmap.database());
  ASSERT_EQ(before.size(), 3u);
  AddLearnedFeatures(colmap, TruthOf(scene), silent);
  for (const auto& [id, count] : ReadFeatureCounts(colmap.database())) EXPECT_EQ(count, features.at(id) + kPoints);
  const std::vector<MatchedPair> after = ReadMatchedPairs(colmap.database());
  ASSERT_EQ(after.size(), 3u);
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(after[i].matches, before[i].matches + kPoints);
    EXPECT_GT(after[i].inliers, before[i].inliers + kPoints / 2);
  }
}

TEST_F(LearnedFeaturesTest, AreNotOnMaskedPixels) {
  Image8 mask{kPlanesWidth, kPlanesHeight, 1, std::vector<uint8_t>(kPlanesWidth * kPlanesHeight, 255)};
  const auto middle = mask.data.begin() + kPlanesWidth * kPlanesHeight / 2;
  std::fill(mask.data.begin(), middle, uint8_t{0});
  fs::create_directories(dir / "masks");
  WritePng(dir / "masks/1.png.png", mask);
  const auto features = ReadFeatureCounts(colmap.database());
  AddLearnedFeatures(colmap, TruthOf(scene), silent);
  const auto counts = ReadFeatureCounts(colmap.database());
  EXPECT_EQ(counts.at(1), features.at(1) + kPoints);
  EXPECT_LT(counts.at(2), features.at(2) + kPoints);
  EXPECT_GT(counts.at(2), features.at(2));
}

TEST_F(LearnedFeaturesTest, OfNoImageChangeNothing) {
  const std::vector<MatchedPair> before = ReadMatchedPairs(colmap.database());
  AddLearnedFeatures(
      colmap,
      [](const ImageF&) {
        return LearnedFeatures{{}, Buffer<float>::Empty({0, 16})};
      },
      silent);
  const std::vector<MatchedPair> after = ReadMatchedPairs(colmap.database());
  ASSERT_EQ(after.size(), before.size());
  for (size_t i = 0; i < after.size(); ++i) EXPECT_EQ(after[i].matches, before[i].matches);
}

}  // namespace
}  // namespace oraclegs
