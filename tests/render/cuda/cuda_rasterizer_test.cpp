// The CUDA rasteriser against the reference numbers and against the CPU's.

#include "oraclegs/render/cuda/cuda_rasterizer.h"

#include "render/cuda/device_scenes.h"
#include "render/golden_scene.h"
#include "render/reference_raster.h"

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

class CudaRasterizerGolden : public OnDevice<testing::TestWithParam<std::string>> {};

TEST_P(CudaRasterizerGolden, ImagesAndGradientsMatch) {
  GoldenScene f;
  f.Select(GetParam());
  cuda::CudaRasterizer rasterizer(TestDevice());
  const RenderedTask out = RunTask(&rasterizer, {f.gaussians, f.camera, f.options, f.upstream}, TestDevice());
  const auto golden = [&](const std::string& name) { return GoldenTensor(f.file, GetParam() + "." + name); };
  EXPECT_LE(MaxAbsError(out.image, golden("image")), 2e-5);
  EXPECT_LE(MaxAbsError(out.alpha, golden("alpha")), 2e-5);
  EXPECT_LE(MaxAbsError(out.inv_depth, golden("inv_depth")), 2e-5);
  out.grads.ForEach([&](const char* name, const Buffer<float>& grad) {
    const Buffer<float> ref = golden(std::string("grad_") + name);
    EXPECT_LE(RelativeL2(grad, ref), 2e-4) << name;
    EXPECT_LE(MaxAbsError(grad, ref), 4e-4 * ref.abs().max().item<double>()) << name;
    ExpectRowsAgree(grad, ref, f.visible, name);
  });
}

INSTANTIATE_TEST_SUITE_P(Variants, CudaRasterizerGolden, testing::Values("sh3", "sh0", "aa"),
                         [](const auto& info) { return info.param; });

struct SceneCase {
  const char* name;
  int64_t gaussians;
  double scale;
  int width, height;
  int sh_degree = 3;
  bool antialiased = false;
  void (*change)(RenderTask*) = nullptr;
};

class CudaRasterizerScenes : public OnDevice<testing::TestWithParam<SceneCase>> {};

/// Share of values that differ by more: decisions at a threshold may fall the other way.
double DifferingShare(const Buffer<float>& a, const Buffer<float>& b, double tolerance) {
  return ((a - b).abs() > tolerance).to(torch::kDouble).mean().item<double>();
}

TEST_P(CudaRasterizerScenes, AgreesWithTheCpu) {
  const SceneCase& c = GetParam();
  RenderTask task{RandomGaussians(c.gaussians, c.scale, 11),
                  FrontCamera(c.width, c.height),
                  {{0.3f, 0.1f, 0.6f}, c.sh_degree, c.antialiased}};
  task.upstream = RandomUpstream(task.camera, 3);
  if (c.change != nullptr) c.change(&task);
  cuda::CudaRasterizer rasterizer(TestDevice());
  const RenderedTask out = RunTask(&rasterizer, task, TestDevice());
  const RenderedTask cpu = RunTask(MakeRasterizer(kCpu).get(), task, kCpu);
  // One contributor at alpha = 1/255 weighs up to 0.4 % of a colour; anything larger is a mistake.
  EXPECT_LE(MaxAbsError(out.image, cpu.image), 0.02);
  EXPECT_LE(DifferingShare(out.image, cpu.image, 3e-5), 0.002);
  EXPECT_LE(DifferingShare(out.alpha, cpu.alpha, 3e-5), 0.002);
  EXPECT_LE(DifferingShare(out.inv_depth, cpu.inv_depth, 3e-5), 0.002);
  const int coefficients = ShCount(c.sh_degree);
  out.grads.ForEach([&](const char* name, const Buffer<float>& grad) {
    Buffer<float> ref;
    cpu.grads.ForEach([&](const char* other, const Buffer<float>& t) {
      if (std::string(other) == name) ref = t;
    });
    EXPECT_TRUE(torch::isfinite(grad).all().item<bool>()) << name;
    if (ref.norm().item<double>() > 0) {
      EXPECT_LE(RelativeL2(grad, ref), 2e-4) << name;
    } else {
      EXPECT_EQ(grad.abs().sum().item<double>(), 0) << name;
    }
  });
  if (coefficients < kShCoefficients) {  // not ours to write
    EXPECT_EQ(out.grads.sh.narrow(1, coefficients, kShCoefficients - coefficients).abs().sum().item<double>(), 0);
  }
  EXPECT_EQ(out.stats.visible, cpu.stats.visible);
  EXPECT_GE(out.stats.tile_pairs, cpu.stats.tile_pairs);  // the CPU asks each 4 x 4 block
  EXPECT_LE(out.stats.tile_pairs, cpu.stats.tile_pairs + cpu.stats.tile_pairs / 10 + 8);
}

void TurnAway(RenderTask* task) { task->gaussians.means.select(1, 2).neg_(); }
void TurnHalfAway(RenderTask* task) {
  task->gaussians.means.narrow(0, 0, task->gaussians.size() / 2).select(1, 2).neg_();
}
void AtThresholds(RenderTask* task) {
  float* logits = task->gaussians.opacity_logits.data();
  const double at[] = {1.0 / 255, 0.9 / 255, 1.1 / 255, 0.98, 0.995, 0.9999, 1e-6};
  for (int64_t i = 0; i < task->gaussians.size(); ++i) {
    const double o = at[i % 7];
    logits[i] = static_cast<float>(std::log(o / (1 - o)));
  }
}
void WithFactors(RenderTask* task) {
  torch::manual_seed(5);
  task->options.opacity_factors = torch::rand({task->gaussians.size()}) * 1.5;
  task->options.opacity_factors.narrow(0, 0, 10).SetZero();
}
void OnlyColour(RenderTask* task) { task->upstream.alpha = task->upstream.inv_depth = Buffer<float>(); }
void OnlyDepth(RenderTask* task) { task->upstream.alpha = task->upstream.image = Buffer<float>(); }

INSTANTIATE_TEST_SUITE_P(
    Scenes, CudaRasterizerScenes,
    testing::Values(SceneCase{"small", 300, 0.02, 70, 49}, SceneCase{"needles_and_sheets", 200, 0.2, 67, 45},
                    SceneCase{"huge", 60, 3.0, 150, 140}, SceneCase{"long_lists", 1200, 0.15, 33, 35},
                    SceneCase{"antialiased", 300, 0.01, 64, 48, 3, true}, SceneCase{"one_pixel", 50, 0.3, 1, 1},
                    SceneCase{"degree_0", 100, 0.1, 40, 30, 0}, SceneCase{"degree_1", 100, 0.1, 40, 30, 1},
                    SceneCase{"degree_2", 100, 0.1, 40, 30, 2}, SceneCase{"none", 0, 0.1, 17, 9},
                    SceneCase{"one", 1, 0.5, 17, 33}, SceneCase{"all_behind", 40, 0.1, 20, 20, 3, false, TurnAway},
                    SceneCase{"half_behind", 150, 0.1, 40, 30, 3, false, TurnHalfAway},
                    SceneCase{"thresholds", 150, 0.1, 40, 30, 3, false, AtThresholds},
                    SceneCase{"factors", 150, 0.1, 40, 30, 3, false, WithFactors},
                    SceneCase{"factors_antialiased", 150, 0.03, 40, 30, 3, true, WithFactors},
                    SceneCase{"only_colour", 100, 0.1, 40, 30, 3, false, OnlyColour},
                    SceneCase{"only_depth", 100, 0.1, 40, 30, 3, false, OnlyDepth}),
    [](const auto& info) { return info.param.name; });

class CudaRasterizerTest : public CudaTest {
 protected:
  RenderTask task{RandomGaussians(120, 0.1, 4), FrontCamera(40, 30)};
};

TEST_F(CudaRasterizerTest, BlocksAreOneBlockOfTheSameNumbers) {
  task.upstream = RandomUpstream(task.camera, 3);
  cuda::CudaRasterizer rasterizer(TestDevice());
  const Gaussians g = OnTestDevice(task.gaussians);
  const RenderedTask out = RunTask(&rasterizer, task, TestDevice());
  rasterizer.Forward(g, task.camera, task.options, RenderPass::kTrain);
  int calls = 0;
  rasterizer.BackwardBlocks(g, OnTestDevice(task.upstream), [&](int64_t begin, int64_t end, const GaussianRows& rows) {
    ++calls;
    EXPECT_EQ(begin, 0);
    EXPECT_EQ(end, 120);
    const Buffer<float> means = torch::from_blob(rows.means, {120, 3}, torch::dtype(torch::kFloat).device(TestDevice()));
    EXPECT_TRUE(torch::equal(means.To(kCpu), out.grads.means));
  });
  EXPECT_EQ(calls, 1);
}

TEST_F(CudaRasterizerTest, GradientsMatchCentralDifferences) {
  RenderTask few{RandomGaussians(12, 0.25, 21), FrontCamera(24, 20), {{0.1f, 0.5f, 0.9f}, 3, true}};
  few.upstream = RandomUpstream(few.camera, 1);
  cuda::CudaRasterizer rasterizer(TestDevice());
  const RenderedTask out = RunTask(&rasterizer, few, TestDevice());
  ReferenceScene scene(few.gaussians, few.camera, few.options);
  const auto loss = [&] {
    const ReferenceImage image = scene.Render();
    double sum = 0;
    for (size_t i = 0; i < image.image.size(); ++i) sum += few.upstream.image.data()[i] * image.image[i];
    for (size_t i = 0; i < image.alpha.size(); ++i) {
      sum += few.upstream.alpha.data()[i] * image.alpha[i] +
             few.upstream.inv_depth.data()[i] * image.inv_depth[i];
    }
    return sum;
  };
  const auto check = [&](const char* name, std::vector<double>& values, const Buffer<float>& grad, size_t stride) {
    const double scale = grad.abs().max().item<double>();
    for (size_t k = 0; k < values.size(); k += stride) {
      double best = 1e30;  // of three steps: a pixel that crosses a threshold on the way is a jump, not a slope
      for (const double step : {1e-4, 1e-5, 1e-6}) {
        const double keep = values[k];
        values[k] = keep + step;
        const double above = loss();
        values[k] = keep - step;
        best = std::min(best, std::abs((above - loss()) / (2 * step) - grad.data()[k]));
        values[k] = keep;
      }
      EXPECT_LE(best, 2e-3 * scale) << name << " " << k;
    }
  };
  check("means", scene.means, out.grads.means, 1);
  check("log_scales", scene.log_scales, out.grads.log_scales, 1);
  check("quats", scene.quats, out.grads.quats, 1);
  check("opacity_logits", scene.opacity_logits, out.grads.opacity_logits, 1);
  check("sh", scene.sh, out.grads.sh, 7);
}

TEST_F(CudaRasterizerTest, RefusesWhatDoesNotFit) {
  cuda::CudaRasterizer rasterizer(TestDevice());
  const Gaussians g = OnTestDevice(task.gaussians);
  Gaussians grads = OnTestDevice(Gaussians::Zeros(120));
  EXPECT_THROW(rasterizer.Backward(g, {}, &grads), ShapeError);  // no Forward yet
  Camera camera = task.camera;
  camera.width = 40000;
  EXPECT_THROW(rasterizer.Forward(g, camera, {}, RenderPass::kTrain), ShapeError);
  EXPECT_THROW(rasterizer.Forward(g, task.camera, {{}, 4, false}, RenderPass::kTrain), ShapeError);
  RenderOptions options;
  options.opacity_factors = Buffer<float>::Full({119}, 1.f);
  EXPECT_THROW(rasterizer.Forward(g, task.camera, options, RenderPass::kTrain), ShapeError);
  rasterizer.Forward(g, task.camera, {}, RenderPass::kInference);
  EXPECT_THROW(rasterizer.Backward(g, {}, &grads), ShapeError);  // it was not to train
  rasterizer.Forward(g, task.camera, {}, RenderPass::kTrain);
  EXPECT_THROW(rasterizer.Backward(g, OnTestDevice(RenderGrads{Buffer<float>::Full({30, 41, 3}, 1.f), {}, {}}), &grads), ShapeError);
  Gaussians few = OnTestDevice(Gaussians::Zeros(119));
  EXPECT_THROW(rasterizer.Backward(g, {}, &few), ShapeError);
  Gaussians elsewhere = g;
  elsewhere.ForEach([](const char*, Buffer<float>& t) { t = t.to(torch::kMeta); });
  EXPECT_THROW(rasterizer.Forward(elsewhere, task.camera, {}, RenderPass::kTrain), ShapeError);
}

#if defined(ORACLEGS_CUDA)
TEST_F(CudaRasterizerTest, IsWhatADeviceGets) {
  const std::unique_ptr<Rasterizer> rasterizer = MakeRasterizer(TestDevice());
  EXPECT_NE(dynamic_cast<cuda::CudaRasterizer*>(rasterizer.get()), nullptr);
}
#endif

TEST_F(CudaRasterizerTest, ADeviceThatIsNotThereIsRefused) {
  EXPECT_THROW(cuda::CudaRasterizer(Device(torch::kCUDA, 99)), UsageError);
}

}  // namespace
}  // namespace oraclegs
