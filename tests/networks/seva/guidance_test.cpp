#include "oraclegs/networks/seva/guidance.h"

#include "networks/seva/sampling_fixture.h"

namespace oraclegs::seva {
namespace {

TEST(SevaGuidance, WeightsAndResultsMatchTheOfficialOnes) {
  const SafetensorsFile file = SamplingFixture();
  const std::vector<View> views = GoldenViews(file, "cfg.c2w", "cfg.K");
  const std::vector<bool> given = GoldenMask(file, "cfg.input_frame_mask");
  ASSERT_EQ(static_cast<float>(file.Values<double>("cfg.min").at(0)), static_cast<float>(kGuidanceBesideAnImage));
  const Tensor both = GoldenFloat(file, "cfg.x_uncond_cond");
  const auto frames = static_cast<int64_t>(views.size());
  const Tensor plain = both.slice(0, 0, frames), conditional = both.slice(0, frames);
  const Tensor weights = GuidanceWeights(views, given, file.Values<double>("cfg.scale").at(0));
  ExpectRatio(weights, GoldenTensor(file, "cfg.multiview_scale"), 1e-5, "weights");
  ExpectRatio(plain + weights.view({-1, 1, 1, 1}) * (conditional - plain), GoldenTensor(file, "cfg.multiview_out"),
              1e-5, "result");
}

TEST(SevaGuidance, RotationsMatchTheOfficialOnes) {
  const SafetensorsFile file = SamplingFixture();
  const std::vector<View> views = GoldenViews(file, "cfg.c2w");
  const std::vector<bool> given = GoldenMask(file, "cfg.input_frame_mask");
  const std::vector<double> expected = file.Values<double>("cfg.rotation_dist_deg");
  size_t place = 0;
  for (const View& view : views) {
    for (size_t j = 0; j < views.size(); ++j) {
      if (!given[j]) continue;
      const double degrees = RotationDegrees(view.world_from_camera.linear(), views[j].world_from_camera.linear());
      EXPECT_NEAR(degrees, expected.at(place++), 0.05);
    }
  }
}

TEST(SevaGuidance, RefusesFramesOfWhichNoneIsGiven) {
  EXPECT_THROW(GuidanceWeights({View{}}, {false}, 3), ShapeError);
  EXPECT_THROW(GuidanceWeights({View{}}, {true, true}, 3), ShapeError);
}

}  // namespace
}  // namespace oraclegs::seva
