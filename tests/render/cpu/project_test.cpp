// Intermediate quantities of projection against the reference numbers, and records carried back to parameters.

#include <vector>

#include "oraclegs/render/constants.h"
#include "oraclegs/render/render_inputs.h"
#include "render/cpu/every_target.h"
#include "render/cpu/splats.h"
#include "render/golden_scene.h"

namespace oraclegs {
namespace {

class ProjectSplats : public EveryTarget {};

TEST_P(ProjectSplats, MatchesTheReferenceNumbers) {
  for (const std::string variant : {"sh3", "aa"}) {
    GoldenScene scene;
    scene.Select(variant);
    const int64_t n = scene.gaussians.size();
    const cpu::ProjectInput in{MakeSplatCamera<float>(scene.camera, scene.options),
                               ForwardParameters(scene.gaussians, scene.camera, scene.options, kCpu)};
    std::vector<cpu::LineSplat> splats(n);
    std::vector<TileRect> rects(n);
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
        // What contributes may not be culled; the file lists it for the variant without opacity compensation.
        EXPECT_TRUE(variant == "aa" || !scene.visible[static_cast<size_t>(i)]) << i;
        continue;
      }
      EXPECT_GT(depths[i], kNearPlane) << i;
      const cpu::LineSplat& s = splats[i];
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
