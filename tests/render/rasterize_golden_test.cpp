// Parity with the reference numbers of docs/method.md#tolerances, on every instruction set this machine has.

#include <hwy/targets.h>

#include "oraclegs/render/render.h"
#include "render/golden_scene.h"

namespace oraclegs {
namespace {

class RasterizeGolden : public testing::TestWithParam<std::tuple<int64_t, std::string>> {
 protected:
  void SetUp() override { hwy::SetSupportedTargetsForTest(std::get<0>(GetParam())); }
  void TearDown() override { hwy::SetSupportedTargetsForTest(0); }
  std::string variant() const { return std::get<1>(GetParam()); }
};

TEST_P(RasterizeGolden, ImagesMatch) {
  GoldenScene f;
  f.Select(variant());
  const RenderOutput out = MakeRasterizer(kCpu)->Forward(f.gaussians, f.camera, f.options, RenderPass::kInference);
  EXPECT_LE(MaxAbsError(out.image, GoldenDouble(f.file, variant() + ".image")), 2e-5);
  EXPECT_LE(MaxAbsError(out.inv_depth, GoldenDouble(f.file, variant() + ".inv_depth")), 2e-5);
  EXPECT_LE(MaxAbsError(out.alpha, GoldenDouble(f.file, variant() + ".alpha")), 2e-5);
}

TEST_P(RasterizeGolden, GradientsMatch) {
  GoldenScene f;
  f.Select(variant());
  auto rasterizer = MakeRasterizer(kCpu);
  rasterizer->Forward(f.gaussians, f.camera, f.options, RenderPass::kTrain);
  Gaussians grads = Gaussians::Zeros(f.gaussians.size());
  rasterizer->Backward(f.gaussians, f.upstream, &grads);
  grads.ForEach([&](const char* name, const Buffer<float>& grad) {
    const std::string key = variant() + ".grad_" + name;
    const Buffer<double> ref = GoldenDouble(f.file, key);
    EXPECT_LE(RelativeL2(grad, ref), 2e-4) << key;
    EXPECT_LE(MaxAbsError(grad, ref), 4e-4 * Flat(ref).abs().maxCoeff()) << key;
    f.ExpectRowsAgree(grad, ref, key);
  });
}

TEST_P(RasterizeGolden, CameraGradientFollowsFromTheGaussians) {
  GoldenScene f;
  f.Select(variant());
  auto rasterizer = MakeRasterizer(kCpu);
  rasterizer->WatchCamera(true);
  rasterizer->Forward(f.gaussians, f.camera, f.options, RenderPass::kTrain);
  Gaussians grads = Gaussians::Zeros(f.gaussians.size());
  rasterizer->Backward(f.gaussians, f.upstream, &grads);
  const CameraGradient gradient = rasterizer->camera_gradient();
  // The image stays the same when camera and Gaussians move as one.
  const Eigen::ArrayXXd of_means = Table(GoldenDouble(f.file, variant() + ".grad_means"));
  const Eigen::ArrayXXd of_quats = Table(GoldenDouble(f.file, variant() + ".grad_quats"));
  Eigen::Vector3d shift = Eigen::Vector3d::Zero(), turn = Eigen::Vector3d::Zero();
  double size = 0;
  for (int64_t i = 0; i < f.gaussians.size(); ++i) {
    const auto row = [](const Buffer<float>& values, int64_t first) {
      return Eigen::Map<const Eigen::Vector3f>(values.data() + first).cast<double>();
    };
    const Eigen::Vector3d arm = row(f.gaussians.means, 3 * i) - f.camera.Center(), g = of_means.row(i).matrix();
    const Eigen::Vector3d axis = row(f.gaussians.quats, 4 * i + 1), g_axis = of_quats.row(i).tail(3).matrix();
    shift += g;
    turn += arm.cross(g) + 0.5 * (f.gaussians.quats[4 * i] * g_axis - of_quats(i, 0) * axis + axis.cross(g_axis));
    size += g.norm();
  }
  const Eigen::Matrix3d rotation = f.camera.cam_from_world.linear();
  EXPECT_LE((gradient.translation - rotation * shift).norm(), 2e-5 * size);
  // Colors of degree 0 do not turn.
  if (f.options.sh_degree == 0) {
    EXPECT_LE((gradient.rotation - rotation * turn).norm(), 2e-4 * turn.norm());
  }
}

std::vector<int64_t> Targets() { return hwy::SupportedAndGeneratedTargets(); }

INSTANTIATE_TEST_SUITE_P(EveryTarget, RasterizeGolden,
                         testing::Combine(testing::ValuesIn(Targets()), testing::Values("sh3", "sh0", "aa")),
                         [](const auto& info) {
                           return std::string(hwy::TargetName(std::get<0>(info.param))) + "_" + std::get<1>(info.param);
                         });

}  // namespace
}  // namespace oraclegs
