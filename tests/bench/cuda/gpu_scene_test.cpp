#include "bench/gpu_scene.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/gaussians/ply.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

TEST(SyntheticScene, HasTheSizeAskedFor) {
  const GpuScene scene = SyntheticScene(50, 48, 32);
  EXPECT_EQ(scene.gaussians.size(), 50);
  ASSERT_EQ(scene.cameras.size(), 3u);
  EXPECT_EQ(scene.cameras[0].width, 48);
  EXPECT_NE(scene.cameras[0].Center().x(), scene.cameras[1].Center().x());
}

TEST(TrainedScene, NeedsNoImages) {
  const TempDir dir;
  WriteGaussianPly(dir / "model.ply", SyntheticScene(20, 48, 32).gaussians);
  nlohmann::json file{{"w", 100}, {"h", 50}, {"fl_x", 80}, {"frames", nlohmann::json::array()}};
  for (int i = 0; i < 5; ++i) {
    file["frames"].push_back({{"file_path", "images/" + std::to_string(i) + ".png"},
                              {"transform_matrix", {{1, 0, 0, i}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}}});
  }
  WriteFileAtomically(dir / "transforms.json", file.dump());
  const GpuScene scene = TrainedScene(dir / "model.ply", dir / "transforms.json", 200 * 100);
  EXPECT_EQ(scene.gaussians.size(), 20);
  ASSERT_EQ(scene.cameras.size(), 3u);
  EXPECT_EQ(scene.cameras[2].width, 200);
  EXPECT_EQ(scene.cameras[2].height, 100);
  EXPECT_NEAR(scene.cameras[2].fx, 160, 1e-9);
  EXPECT_NEAR(scene.cameras[2].Center().x(), 2, 1e-9);
}

TEST(TrainedScene, NamesTheFileThatIsMissing) { EXPECT_THROW(TrainedScene("no.ply", "no.json", 100), InputError); }

}  // namespace
}  // namespace oraclegs
