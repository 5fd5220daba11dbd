#include "oraclegs/experiments/tampered_views.h"

#include <nlohmann/json.hpp>

#include "oraclegs/gaussians/initialize.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/propose/folder.h"
#include "oraclegs/propose/proposal_files.h"
#include "support/errors.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;

/// A wall of colored Gaussians at a depth of 2.
ProxyModel Wall(float brightness) {
  PointCloud cloud;
  for (int y = -20; y <= 20; ++y) {
    for (int x = -20; x <= 20; ++x) {
      cloud.xyz.emplace_back(0.06f * static_cast<float>(x), 0.06f * static_cast<float>(y), 2.f);
      cloud.rgb.emplace_back((x / 4 + y / 4) % 2 == 0 ? brightness : 0.1f, 0.5f, x > 0 ? 0.2f : 0.7f);
    }
  }
  return {{}, InitializeGaussians(cloud, {0.7, 0.95}), {}};
}

std::vector<Target> TwoTargets() {
  Target left{"left", {}};
  left.camera.width = 48, left.camera.height = 36;
  left.camera.fx = left.camera.fy = 48, left.camera.cx = 24, left.camera.cy = 18;
  Target right = left;
  right.name = "right";
  right.camera.cam_from_world.translation() = Eigen::Vector3d(-0.3, 0, 0);
  return {left, right};
}

ViewTamperer Tamperer(uint64_t seed = 5) {
  return {{Wall(0.8f), Wall(0.9f)}, RenderOptions{{0, 0, 0}, 0}, TwoTargets(), seed};
}

TEST(ViewTamperer, ReachesTheShareWithTheFewestLies) {
  const ViewTamperer tamperer = Tamperer();
  size_t before = 0;
  for (const double share : {0.1, 0.3, 0.5}) {
    const TamperedViews views = tamperer.Reach(share);
    EXPECT_GE(views.share, share);
    EXPECT_LT(views.share, share + 0.15) << "a lie more than needed";
    EXPECT_GE(views.lies, before);
    before = views.lies;
    double tampered = 0, pixels = 0;
    for (size_t v = 0; v < views.masks.size(); ++v) {
      for (size_t i = 0; i < views.masks[v].size(); ++i) {
        float difference = 0;
        for (size_t c = 3 * i; c < 3 * i + 3; ++c) {
          difference =
              std::max(difference, std::abs(views.proposals[v].rgb.data[c] - tamperer.honest()[v].rgb.data[c]));
        }
        EXPECT_EQ(views.masks[v][i] != 0, difference > kHonestDifference);
        tampered += views.masks[v][i] != 0, ++pixels;
      }
    }
    EXPECT_DOUBLE_EQ(views.share, tampered / pixels);
  }
}

TEST(ViewTamperer, KnowsWhichKindMadeAPixelDiffer) {
  const ViewTamperer tamperer = Tamperer();
  const TamperedViews views = tamperer.Reach(0.3), honest = tamperer.Reach(0);
  size_t tampered = 0, explained = 0;
  for (size_t i = 0; i < views.masks[0].size(); ++i) {
    tampered += views.masks[0][i] != 0;
    explained += views.masks[0][i] != 0 && views.kinds[0][i] != 0;
    EXPECT_EQ(honest.kinds[0][i], 0);
  }
  EXPECT_GT(explained, tampered * 9 / 10) << "but where lies of several kinds add up";
}

TEST(ViewTamperer, LeavesAllOrNothing) {
  const ViewTamperer tamperer = Tamperer();
  const TamperedViews none = tamperer.Reach(0), all = tamperer.Reach(1);
  EXPECT_EQ(none.share, 0);
  EXPECT_EQ(none.proposals[1].rgb.data, tamperer.honest()[1].rgb.data);
  EXPECT_EQ(all.share, 1);
  EXPECT_EQ(std::count(all.masks[0].begin(), all.masks[0].end(), 255), 48 * 36);
  EXPECT_NE(all.proposals[0].rgb.data, tamperer.honest()[0].rgb.data);
}

TEST(ViewTamperer, IsAFunctionOfTheSeed) {
  EXPECT_EQ(Tamperer().Reach(0.3).proposals[0].rgb.data, Tamperer().Reach(0.3).proposals[0].rgb.data);
  EXPECT_NE(Tamperer(5).Reach(0.3).proposals[0].rgb.data, Tamperer(6).Reach(0.3).proposals[0].rgb.data);
}

TEST(WriteTamperedViews, WritesFoldersOfProposals) {
  const TempDir temp;
  const TamperedViews views = Tamperer().Reach(0.3);
  WriteTamperedViews(temp.path(), views);
  Camera train = TwoTargets()[0].camera;
  train.cam_from_world.translation() = Eigen::Vector3d(0, 1, 0);
  const FolderRequest request{{train, TwoTargets()[1].camera}, {}, {}, 48, 36};
  const FolderProposals pictures = ReadProposalFolder(temp / "pictures", request, Silent());
  const FolderProposals ideal = ReadProposalFolder(temp / "ideal", request, Silent());
  ASSERT_EQ(pictures.proposals.size(), 2u);
  EXPECT_TRUE(pictures.confidence[0].empty());
  EXPECT_EQ(ideal.proposals[1].rgb.data, pictures.proposals[1].rgb.data);
  for (size_t i = 0; i < views.masks[0].size(); ++i) {
    ASSERT_EQ(ideal.confidence[0][i], views.masks[0][i] != 0 ? 0.f : 1.f);
  }
  EXPECT_EQ(ReadMask(temp / "masks" / "right.png", TwoTargets()[1].camera), views.masks[1]);
}

TEST(ReadMask, RefusesAnotherSize) {
  const TempDir temp;
  WriteMask(temp / "m.png", PixelMask(48 * 36, 255), TwoTargets()[0].camera);
  EXPECT_THAT(MessageOf<InputError>([&] { ReadMask(temp / "m.png", Resized(TwoTargets()[0].camera, 24, 18)); }),
              HasSubstr("m.png: is 48 x 36, not 24 x 18"));
}

}  // namespace
}  // namespace oraclegs
