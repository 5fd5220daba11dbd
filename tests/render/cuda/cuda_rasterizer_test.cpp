// The CUDA rasterizer against the reference numbers and against the CPU's.

#include "oraclegs/render/render.h"

#include "render/cuda/device_scenes.h"
#include "render/golden_scene.h"
#include "render/reference_raster.h"
#include "support/finite_difference.h"

namespace oraclegs {
namespace {

class CudaRasterizerGolden : public OnDevice<testing::TestWithParam<std::string>> {};

TEST_P(CudaRasterizerGolden, ImagesAndGradientsMatch) {
  GoldenScene f;
  f.Select(GetParam());
  const auto rasterizer = cuda::MakeCudaRasterizer(TestDevice());
  const RenderedTask out = RunTask(rasterizer.get(), {f.gaussians, f.camera, f.options, f.upstream}, TestDevice());
  const auto golden = [&](const std::string& name) { return GoldenDouble(f.file, GetParam() + "." + name); };
  EXPECT_LE(MaxAbsError(out.image, golden("image")), 2e-5);
  EXPECT_LE(MaxAbsError(out.alpha, golden("alpha")), 2e-5);
  EXPECT_LE(MaxAbsError(out.inv_depth, golden("inv_depth")), 2e-5);
  out.grads.ForEach([&](const char* name, const Buffer<float>& grad) {
    const Buffer<double> ref = golden(std::string("grad_") + name);
    EXPECT_LE(RelativeL2(grad, ref), 2e-4) << name;
    EXPECT_LE(MaxAbsError(grad, ref), 4e-4 * Flat(ref).abs().maxCoeff()) << name;
    f.ExpectRowsAgree(grad, ref, name);
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

/// Fraction of values that differ by more: decisions at a threshold may fall the other way.
double DifferingShare(const Buffer<float>& a, const Buffer<float>& b, double tolerance) {
  return ((Flat(a) - Flat(b)).abs().cast<double>() > tolerance).cast<double>().mean();
}

TEST_P(CudaRasterizerScenes, AgreesWithTheCpu) {
  const SceneCase& c = GetParam();
  RenderTask task{RandomGaussians(c.gaussians, c.scale, 11),
                  FrontCamera(c.width, c.height),
                  {{0.3f, 0.1f, 0.6f}, c.sh_degree, c.antialiased}};
  task.upstream = RandomUpstream(task.camera, 3);
  if (c.change != nullptr) c.change(&task);
  const auto rasterizer = cuda::MakeCudaRasterizer(TestDevice());
  const RenderedTask out = RunTask(rasterizer.get(), task, TestDevice());
  const RenderedTask cpu = RunTask(MakeRasterizer(kCpu).get(), task, kCpu);
  // One contributor at alpha = 1/255 weighs up to 0.4 % of a color; anything larger is a mistake.
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
    EXPECT_TRUE(AllFinite(grad)) << name;
    if (grad.count() > 0 && MaxAbs(ref) > 0) {
      EXPECT_LE(RelativeL2(grad, ref), 2e-4) << name;
    } else {
      EXPECT_TRUE((Flat(grad) == 0).all()) << name;
    }
  });
  if (coefficients < kShCoefficients) {  // not ours to write
    EXPECT_TRUE((Table(out.grads.sh).rightCols(kShFloats - 3 * coefficients) == 0).all());
  }
  EXPECT_EQ(out.stats.visible, cpu.stats.visible);
  EXPECT_GE(out.stats.tile_pairs, cpu.stats.tile_pairs);  // the CPU asks each 4 x 4 block
  EXPECT_LE(out.stats.tile_pairs, cpu.stats.tile_pairs + cpu.stats.tile_pairs / 10 + 8);
}

void TurnAway(RenderTask* task) { Table(task->gaussians.means).col(2) *= -1; }
void TurnHalfAway(RenderTask* task) { Table(task->gaussians.means.Rows(0, task->gaussians.size() / 2)).col(2) *= -1; }
void AtThresholds(RenderTask* task) {
  float* logits = task->gaussians.opacity_logits.data();
  // As near to 1/255 as exponentials that differ in their last bits allow: all devices must see the same Gaussians.
  const double at[] = {1.00001 / 255, 0.99999 / 255, 0.9 / 255, 1.1 / 255, 0.98, 0.995, 0.9999, 1e-6};
  for (int64_t i = 0; i < task->gaussians.size(); ++i) {
    const double o = at[i % 8];
    logits[i] = static_cast<float>(std::log(o / (1 - o)));
  }
}
void WithFactors(RenderTask* task) {
  const Buffer<float> factors = RandomUniform({task->gaussians.size()}, 5);
  Flat(factors) *= 1.5f;
  factors.Rows(0, 10).SetZero();
  task->options.opacity_factors = factors;
}
void OnlyColor(RenderTask* task) { task->upstream.alpha = task->upstream.inv_depth = Buffer<float>(); }
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
                    SceneCase{"only_color", 100, 0.1, 40, 30, 3, false, OnlyColor},
                    SceneCase{"only_depth", 100, 0.1, 40, 30, 3, false, OnlyDepth}),
    [](const auto& info) { return info.param.name; });

class CudaRasterizerTest : public CudaTest {
 protected:
  RenderTask task{RandomGaussians(120, 0.1, 4), FrontCamera(40, 30)};
};

TEST_F(CudaRasterizerTest, PassesTheSameGradientsToAConsumer) {
  task.upstream = RandomUpstream(task.camera, 3);
  const auto rasterizer = cuda::MakeCudaRasterizer(TestDevice());
  const Gaussians g = OnTestDevice(task.gaussians);
  const RenderedTask out = RunTask(rasterizer.get(), task, TestDevice());
  rasterizer->Forward(g, task.camera, task.options, RenderPass::kTrain);
  Gaussians grads = OnTestDevice(Gaussians::Zeros(120));
  WritingConsumer consumer(&grads);
  rasterizer->BackwardInto(g, OnTestDevice(task.upstream), &consumer);
  EXPECT_EQ(consumer.calls, 1);
  EXPECT_TRUE(Equal(OnHost(grads.means), out.grads.means));
  EXPECT_TRUE(Equal(OnHost(grads.sh), out.grads.sh));
}

TEST_F(CudaRasterizerTest, GradientsMatchCentralDifferences) {
  RenderTask few{RandomGaussians(12, 0.25, 21), FrontCamera(24, 20), {{0.1f, 0.5f, 0.9f}, 3, true}};
  few.upstream = RandomUpstream(few.camera, 1);
  const auto rasterizer = cuda::MakeCudaRasterizer(TestDevice());
  const RenderedTask out = RunTask(rasterizer.get(), few, TestDevice());
  ReferenceScene scene(few.gaussians, few.camera, few.options);
  const auto loss = [&] { return scene.Loss(few.upstream); };
  ExpectCentralDifferences("means", loss, scene.means, out.grads.means);
  ExpectCentralDifferences("log_scales", loss, scene.log_scales, out.grads.log_scales);
  ExpectCentralDifferences("quats", loss, scene.quats, out.grads.quats);
  ExpectCentralDifferences("opacity_logits", loss, scene.opacity_logits, out.grads.opacity_logits);
  ExpectCentralDifferences("sh", loss, scene.sh, out.grads.sh, 7);
}

TEST_F(CudaRasterizerTest, RefusesWhatDoesNotFit) {
  const auto rasterizer = cuda::MakeCudaRasterizer(TestDevice());
  const Gaussians g = OnTestDevice(task.gaussians);
  Gaussians grads = OnTestDevice(Gaussians::Zeros(120));
  EXPECT_THROW(rasterizer->Backward(g, {}, &grads), ShapeError);  // no Forward yet
  Camera camera = task.camera;
  camera.width = 40000;
  EXPECT_THROW(rasterizer->Forward(g, camera, {}, RenderPass::kTrain), ShapeError);
  EXPECT_THROW(rasterizer->Forward(g, task.camera, {{}, 4, false}, RenderPass::kTrain), ShapeError);
  RenderOptions options;
  options.opacity_factors = Buffer<float>::Full({119}, 1.f);
  EXPECT_THROW(rasterizer->Forward(g, task.camera, options, RenderPass::kTrain), ShapeError);
  rasterizer->Forward(g, task.camera, {}, RenderPass::kInference);
  EXPECT_THROW(rasterizer->Backward(g, {}, &grads), ShapeError);  // it was not to train
  rasterizer->Forward(g, task.camera, {}, RenderPass::kTrain);
  EXPECT_THROW(
      rasterizer->Backward(g, OnTestDevice(RenderGrads{Buffer<float>::Full({30, 41, 3}, 1.f), {}, {}}), &grads),
      ShapeError);
  Gaussians few = OnTestDevice(Gaussians::Zeros(119));
  EXPECT_THROW(rasterizer->Backward(g, {}, &few), ShapeError);
  Gaussians elsewhere = g;
  elsewhere.ForEach([](const char*, Buffer<float>& t) {
    t = Buffer<float>::Wrap(t.data(), t.shape(), {DeviceKind::kCuda, 7}, t.storage());
  });
  EXPECT_THROW(rasterizer->Forward(elsewhere, task.camera, {}, RenderPass::kTrain), ShapeError);
}

TEST_F(CudaRasterizerTest, RefusesAMissingDevice) {
  EXPECT_THROW(cuda::MakeCudaRasterizer({DeviceKind::kCuda, 99}), UsageError);
}

}  // namespace
}  // namespace oraclegs
