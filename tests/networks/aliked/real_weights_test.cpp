// ALIKED with its published weights on photos. $ORACLEGS_TEST_WEIGHTS names a folder with aliked-n16.pth,
// $ORACLEGS_DATA one with the scene fox.

#include <gmock/gmock.h>

#include <cstdlib>

#include "oraclegs/image/read_image.h"
#include "oraclegs/networks/aliked/aliked.h"
#include "oraclegs/sfm/colmap_database.h"
#include "oraclegs/sfm/learned_features.h"
#include "oraclegs/weights/convert.h"
#include "support/temp_dir.h"

namespace oraclegs::aliked {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFirst = "0019.jpg";
constexpr const char* kSecond = "0035.jpg";
constexpr int kMinInliers = 80;  // beyond those of SIFT

fs::path FolderOf(const char* variable) {
  const char* folder = std::getenv(variable);
  return folder ? folder : "";
}

TEST(RealAliked, MatchesPhotosThatLookFromThirtyDegreesApart) {
  const fs::path published = FolderOf("ORACLEGS_TEST_WEIGHTS") / "aliked-n16.pth";
  const fs::path photos = FolderOf("ORACLEGS_DATA") / "fox/images";
  if (!fs::exists(published) || !fs::exists(photos)) {
    GTEST_SKIP() << "needs aliked-n16.pth in $ORACLEGS_TEST_WEIGHTS and fox/images in $ORACLEGS_DATA";
  }
  const TempDir dir;
  ConvertRequest request{{published}, dir / "model.safetensors"};
  request.model = &WeightsNamed("aliked-n16");
  std::string warnings;
  const Listener listener = [&](const Event& event) {
    if (const auto* warning = std::get_if<Warning>(&event)) warnings += warning->text;
  };
  EXPECT_EQ(ConvertWeights(request, listener), 68u);
  EXPECT_EQ(warnings, "");
  const auto network = LoadKeypointNetwork(request.to, torch::kCPU);

  fs::create_directories(dir / "images");
  for (const char* name : {kFirst, kSecond}) fs::copy_file(photos / name, dir / "images" / name);
  const ColmapRunner colmap(dir.path(), listener, "register");
  colmap.ExtractFeatures("SIMPLE_RADIAL", false);
  colmap.MatchExhaustively();
  const std::vector<MatchedPair> sift = ReadMatchedPairs(colmap.database());
  const int with_sift = sift.empty() ? 0 : sift[0].inliers;
  AddLearnedFeatures(
      colmap,
      [&](const ImageF& rgb) {
        ImageFeatures found = network->Find(rgb, KeypointOptions());
        EXPECT_GT(found.keypoints.size(), 800u);
        return LearnedFeatures{std::move(found.keypoints), std::move(found.descriptors)};
      },
      listener);
  EXPECT_GT(ReadMatchedPairs(colmap.database()).at(0).inliers, with_sift + kMinInliers);
}

}  // namespace
}  // namespace oraclegs::aliked
