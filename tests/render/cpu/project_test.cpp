// Intermediate quantities of projection against the fixture, and records carried back to parameters.

#include <vector>

#include "oraclegs/render/constants.h"
#include "render/cpu/every_target.h"
#include "render/cpu/splats.h"
#include "render/golden_scene.h"

namespace oraclegs {
namespace {

cpu::ProjectInput MakeInput(const GoldenScene& scene) {
  cpu::ProjectInput in{};
  in.means = scene.gaussians.means.data();
  in.log_scales = scene.gaussians.log_scales.data();
  in.quats = scene.gaussians.quats.data();
  in.opacity_logits = scene.gaussians.opacity_logits.data();
  in.sh = scene.gaussians.sh.data();
  const Camera& c = scene.camera;
  const Eigen::Vector3d eye = c.Center();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) in.r[3 * i + j] = static_cast<float>(c.cam_from_world.linear()(i, j));
    in.t[i] = static_cast<float>(c.cam_from_world.translation()[i]);
    in.eye[i] = static_cast<float>(eye[i]);
  }
  in.fx = static_cast<float>(c.fx), in.fy = static_cast<float>(c.fy);
  in.cx = static_cast<float>(c.cx), in.cy = static_cast<float>(c.cy);
  in.min_u = static_cast<float>(-(c.cx + 0.15 * c.width) / c.fx);
  in.max_u = static_cast<float>((1.15 * c.width - c.cx) / c.fx);
  in.min_v = static_cast<float>(-(c.cy + 0.15 * c.height) / c.fy);
  in.max_v = static_cast<float>((1.15 * c.height - c.cy) / c.fy);
  in.width = c.width, in.height = c.height;
  in.tiles_x = (c.width + cpu::kTile - 1) / cpu::kTile, in.tiles_y = (c.height + cpu::kTile - 1) / cpu::kTile;
  in.sh_degree = scene.options.sh_degree;
  in.antialiased = scene.options.antialiased;
  return in;
}

class ProjectSplats : public EveryTarget {};

TEST_P(ProjectSplats, IntermediateQuantitiesMatchTheFixture) {
  for (const std::string variant : {"sh3", "aa"}) {
    GoldenScene scene;
    scene.Select(variant);
    const int64_t n = scene.gaussians.size();
    const cpu::ProjectInput in = MakeInput(scene);
    std::vector<cpu::Splat> splats(n);
    std::vector<cpu::TileRect> rects(n);
    // In uneven pieces: a piece's last vector is only partly filled.
    for (int64_t begin = 0; begin < n; begin += 37) {
      cpu::ProjectSplats(in, begin, std::min(n, begin + 37), splats.data(), rects.data());
    }
    const auto values = [&](const char* name) { return scene.file.Values<double>(variant + "." + name); };
    const auto means = values("means2d"), conics = values("conics"), depths = values("depths");
    const auto colors = values("colors"), opacities = values("effective_opacities");
    const double log2e = 1.442695040888963;
    for (int64_t i = 0; i < n; ++i) {
      if (rects[i].Count() == 0) {
        // What contributes may not be culled; the fixture says it for the variant without loss of opacity.
        EXPECT_TRUE(variant == "aa" || !scene.visible[static_cast<size_t>(i)]) << i;
        continue;
      }
      EXPECT_GT(depths[i], kNearPlane) << i;
      const cpu::Splat& s = splats[i];
      EXPECT_NEAR(s.mx, means[2 * i], 1e-4 * std::max(1.0, std::abs(means[2 * i])));
      EXPECT_NEAR(s.my, means[2 * i + 1], 1e-4 * std::max(1.0, std::abs(means[2 * i + 1])));
      EXPECT_NEAR(s.depth, depths[i], 1e-5 * depths[i]);
      EXPECT_NEAR(s.inv_z, 1 / depths[i], 1e-5 / depths[i]);
      EXPECT_NEAR(std::exp2(s.log2_opacity), opacities[i], 1e-5);
      // The sum of squares, multiplied out: ax^2 + (by slope)^2, by^2 slope, by^2.
      const double size = std::abs(conics[3 * i]) + std::abs(conics[3 * i + 2]), by2 = double{s.by} * s.by;
      EXPECT_NEAR((double{s.ax} * s.ax + by2 * s.slope * s.slope) / (0.5 * log2e), conics[3 * i], 2e-5 * size);
      EXPECT_NEAR(by2 * s.slope / (0.5 * log2e), conics[3 * i + 1], 2e-5 * size);
      EXPECT_NEAR(by2 / (0.5 * log2e), conics[3 * i + 2], 2e-5 * size);
      EXPECT_NEAR(s.r, colors[3 * i], 1e-5);
      EXPECT_NEAR(s.g, colors[3 * i + 1], 1e-5);
      EXPECT_NEAR(s.b, colors[3 * i + 2], 1e-5);
    }
  }
}

INSTANTIATE_FOR_EVERY_TARGET(ProjectSplats);

}  // namespace
}  // namespace oraclegs
