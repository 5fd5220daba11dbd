#include "oraclegs/stages/pseudo_depth.h"

#include "depth/surfaces.h"
#include "oraclegs/networks/loader.h"
#include "run/fixtures.h"
#include "support/buffers.h"
#include "support/errors.h"
#include "support/event_recorder.h"
#include "support/network_files.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

TEST(NetworkPseudoDepth, IsWhatTheNetworkSeesInTheRender) {
  SKIP_WITHOUT_NETWORKS();
  const TempDir temp;
  EventRecorder recorder;
  const auto file = WriteTinyDepthAnything(temp / "depth.safetensors");
  const Buffer<float> image = RandomUniform({30, 40, 3}, 3);
  const auto network = GetNetworks().LoadDepth(file, kCpu);
  const Buffer<float> expected = network->InverseDepth({40, 30, 3, {image.span().begin(), image.span().end()}});
  int asked = 0;
  const PseudoDepth depth = NetworkPseudoDepth(file, kCpu, recorder.AsListener());
  const Buffer<float> of_image = depth({}, image, [&](const DepthTarget& target) {
    ++asked;
    EXPECT_TRUE(SameBytes(target.inv_depth, expected));
    EXPECT_FALSE(target.mask.defined());
    return RandomNormal(target.inv_depth.shape(), 4);
  });
  EXPECT_EQ(asked, 1);
  EXPECT_EQ(of_image.shape(), image.shape());
  EXPECT_GT(Flat(of_image).abs().maxCoeff(), 0);
}

TEST(NetworkPseudoDepth, RefusesAFileThatIsNone) {
  SKIP_WITHOUT_NETWORKS();
  EXPECT_THROW(NetworkPseudoDepth("/nowhere/depth.safetensors", kCpu, Silent()), InputError);
}

/// Photos of a textured wall, whose depth is known.
class StereoPseudoDepthTest : public testing::Test {
 protected:
  StereoPseudoDepthTest() {
    for (const Camera& camera : Arc(4, 6)) {
      views.push_back(wall.Take(camera, fmt::format("p{}", views.size())));
      maps.push_back(TrueDepth(views.back(), wall, 0.9f));
    }
  }
  DepthTarget Ask(const Camera& camera) const {
    DepthTarget seen;
    const Buffer<float> image = Buffer<float>::Zeros({camera.height, camera.width, 3});
    const Buffer<float> of_image = StereoPseudoDepth(views, maps)(camera, image, [&](const DepthTarget& target) {
      seen = target;
      return Buffer<float>::Zeros(target.inv_depth.shape());
    });
    EXPECT_FALSE(of_image.defined());
    return seen;
  }

  TexturedPlane wall;
  std::vector<LoadedView> views;
  std::vector<DepthMap> maps;
};

TEST_F(StereoPseudoDepthTest, IsTheDepthOfTheSurfaceFromAnotherPlace) {
  const Camera between = CameraAt({0.2, 0, -4}, {0, 0, 0}, 96, 72);
  const DepthTarget target = Ask(between);
  int64_t right = 0, counted = 0;
  for (int y = 0; y < between.height; ++y) {
    for (int x = 0; x < between.width; ++x) {
      const int64_t i = int64_t{y} * between.width + x;
      if (target.mask[i] == 0) continue;
      ++counted;
      right += std::abs(target.inv_depth[i] * wall.DepthAt(between, x + 0.5, y + 0.5) - 1) < 0.02 ? 1 : 0;
    }
  }
  EXPECT_GT(counted, between.width * between.height / 2);
  EXPECT_GT(right, counted * 95 / 100);
}

TEST_F(StereoPseudoDepthTest, CountsNothingWhereNoDepthIsKnown) {
  for (DepthMap& map : maps) std::fill(map.confidence.begin(), map.confidence.end(), 0.f);
  EXPECT_EQ(Flat(Ask(views[0].camera).mask).maxCoeff(), 0);
}

TEST_F(StereoPseudoDepthTest, RefusesAMapOfNoView) {
  maps.push_back(maps[0]);
  EXPECT_THROW(StereoPseudoDepth(views, maps), ShapeError);
}

}  // namespace
}  // namespace oraclegs
