// Parity with the reference numbers of spec/gaussian_core.md 12, on every instruction set this machine has.

#include <hwy/targets.h>

#include "oraclegs/render/render.h"
#include "render/golden_scene.h"

namespace oraclegs {
namespace {

/// Row by row: |error| <= 0.02 (|ref| + 0.01 median |ref| over visible).
void ExpectRowsAgree(const Buffer<float>& x, const Buffer<float>& ref, const Buffer<float>& visible, const std::string& what) {
  const int64_t n = ref.size(0);
  const Buffer<float> r = ref.reshape({n, -1});
  const Buffer<float> error = (x.to(torch::kDouble).reshape({n, -1}) - r).norm(2, {1}), norm = r.norm(2, {1});
  const double median = norm.index({visible}).median().item<double>();
  const Buffer<float> excess = error / (0.02 * (norm + 0.01 * median));
  EXPECT_LE(excess.max().item<double>(), 1.0) << what << ", Gaussian " << excess.argmax().item<int64_t>();
}

class RasterizeGolden : public testing::TestWithParam<std::tuple<int64_t, std::string>> {
 protected:
  void SetUp() override { hwy::SetSupportedTargetsForTest(std::get<0>(GetParam())); }
  void TearDown() override { hwy::SetSupportedTargetsForTest(0); }
  std::string variant() const { return std::get<1>(GetParam()); }
};

TEST_P(RasterizeGolden, ImagesMatch) {
  GoldenScene f;
  f.Select(variant());
  const RenderOutput out =
      MakeRasterizer(kCpu)->Forward(f.gaussians, f.camera, f.options, RenderPass::kInference);
  EXPECT_LE(MaxAbsError(out.image, GoldenTensor(f.file, variant() + ".image")), 2e-5);
  EXPECT_LE(MaxAbsError(out.inv_depth, GoldenTensor(f.file, variant() + ".inv_depth")), 2e-5);
  EXPECT_LE(MaxAbsError(out.alpha, GoldenTensor(f.file, variant() + ".alpha")), 2e-5);
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
    const Buffer<float> ref = GoldenTensor(f.file, key);
    EXPECT_LE(RelativeL2(grad, ref), 2e-4) << key;
    EXPECT_LE(MaxAbsError(grad, ref), 4e-4 * ref.abs().max().item<double>()) << key;
    ExpectRowsAgree(grad, ref, f.visible, key);
  });
}

std::vector<int64_t> Targets() { return hwy::SupportedAndGeneratedTargets(); }

INSTANTIATE_TEST_SUITE_P(EveryTarget, RasterizeGolden,
                         testing::Combine(testing::ValuesIn(Targets()), testing::Values("sh3", "sh0", "aa")),
                         [](const auto& info) {
                           return std::string(hwy::TargetName(std::get<0>(info.param))) + "_" + std::get<1>(info.param);
                         });

}  // namespace
}  // namespace oraclegs
