// The promises of render.h: bits, buffers, shapes, odd numbers.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <limits>

#include "oraclegs/core/parallel.h"
#include "oraclegs/render/render.h"
#include "render/scenes.h"
#include "support/buffers.h"

namespace oraclegs {
namespace {

/// Consumer that passes blocks to a function.
class BlockConsumer final : public GradientConsumer {
 public:
  explicit BlockConsumer(std::function<void(int64_t, int64_t, const GaussianRows&)> consume)
      : consume_(std::move(consume)) {}
  void ConsumeBlock(int64_t begin, int64_t end, const GaussianRows& grads) override { consume_(begin, end, grads); }

 private:
  std::function<void(int64_t, int64_t, const GaussianRows&)> consume_;
};

TEST(CpuRasterizer, SameBitsForAnyNumberOfThreads) {
  const Gaussians g = RandomGaussians(20000, 0.05, 3);
  const Camera camera = FrontCamera(150, 110);
  const RenderGrads up = RandomUpstream(camera, 2);
  const auto run = [&](int threads) {
    SetNumThreads(threads);
    auto rasterizer = MakeRasterizer(kCpu);
    const RenderOutput out = rasterizer->Forward(g, camera, {}, RenderPass::kTrain);
    Gaussians grads = Gaussians::Zeros(g.size());
    rasterizer->Backward(g, up, &grads);
    return std::pair(out, grads);
  };
  const auto [one, one_grads] = run(1);
  for (const int threads : {2, 3, 7}) {
    const auto [many, many_grads] = run(threads);
    EXPECT_TRUE(SameBytes(one.image, many.image));
    EXPECT_TRUE(SameBytes(one.inv_depth, many.inv_depth));
    EXPECT_TRUE(SameBytes(one_grads.means, many_grads.means));
    EXPECT_TRUE(SameBytes(one_grads.log_scales, many_grads.log_scales));
    EXPECT_TRUE(SameBytes(one_grads.quats, many_grads.quats));
    EXPECT_TRUE(SameBytes(one_grads.opacity_logits, many_grads.opacity_logits));
    EXPECT_TRUE(SameBytes(one_grads.sh, many_grads.sh));
  }
  SetNumThreads(0);
}

TEST(CpuRasterizer, IgnoresOlderContentsOfBuffers) {
  auto rasterizer = MakeRasterizer(kCpu);
  rasterizer->Forward(RandomGaussians(5000, 0.1, 1), FrontCamera(200, 160), {}, RenderPass::kTrain);
  const Gaussians g = RandomGaussians(300, 0.1, 2);
  const RenderOutput reused = rasterizer->Forward(g, FrontCamera(40, 30), {}, RenderPass::kTrain);
  const RenderOutput fresh = MakeRasterizer(kCpu)->Forward(g, FrontCamera(40, 30), {}, RenderPass::kTrain);
  EXPECT_TRUE(SameBytes(reused.image, fresh.image));
  EXPECT_TRUE(SameBytes(reused.inv_depth, fresh.inv_depth));
}

TEST(CpuRasterizer, IgnoresHigherCoefficients) {
  Gaussians g = RandomGaussians(200, 0.1, 9);
  Table(g.sh).rightCols(36).setConstant(std::numeric_limits<float>::quiet_NaN());
  auto rasterizer = MakeRasterizer(kCpu);
  const RenderOutput out = rasterizer->Forward(g, FrontCamera(32, 32), {{0, 0, 0}, 1, false}, RenderPass::kTrain);
  EXPECT_TRUE(AllFinite(out.image));
  Gaussians grads = Gaussians::Zeros(200);
  Flat(grads.sh).setConstant(7);
  rasterizer->Backward(g, {Buffer<float>::Full({32, 32, 3}, 1.f), {}, {}}, &grads);
  EXPECT_TRUE((Table(grads.sh).rightCols(36) == 7).all());
  EXPECT_TRUE(AllFinite(grads.sh));
}

TEST(CpuRasterizer, PassesEachBlockOnceToAConsumer) {
  constexpr int64_t kCount = 5 * kGradBlock + 37;
  Gaussians g = RandomGaussians(kCount, 0.1, 9);
  Flat(g.means.Rows(2 * kGradBlock, 3 * kGradBlock)).setConstant(-5.f);  // a block behind the camera
  const RenderGrads up{Buffer<float>::Full({40, 50, 3}, 1.f), {}, {}};
  auto rasterizer = MakeRasterizer(kCpu);
  rasterizer->Forward(g, FrontCamera(50, 40), {{0, 0, 0}, 2, false}, RenderPass::kTrain);
  Gaussians whole = Gaussians::Zeros(kCount);
  rasterizer->Backward(g, up, &whole);
  EXPECT_GT(MaxAbs(whole.sh), 0);
  for (const int threads : {1, 3}) {
    SetNumThreads(threads);
    Gaussians pieces = Gaussians::Empty(kCount);
    pieces.ForEach([](const char*, Buffer<float>& t) { Flat(t).setConstant(-7.f); });
    Table(pieces.sh).rightCols(21).setZero();
    const GaussianRows all = pieces.Rows();
    std::atomic<int64_t> rows = 0;
    BlockConsumer consumer([&](int64_t begin, int64_t end, const GaussianRows& grads) {
      EXPECT_EQ(begin % kGradBlock, 0);
      const int64_t m = end - begin;
      rows += m;
      const GaussianRows to = all.From(begin);
      std::copy_n(grads.means, 3 * m, to.means);
      std::copy_n(grads.log_scales, 3 * m, to.log_scales);
      std::copy_n(grads.quats, 4 * m, to.quats);
      std::copy_n(grads.opacity_logits, m, to.opacity_logits);
      for (int64_t i = 0; i < m; ++i) std::copy_n(grads.sh + kShFloats * i, 27, to.sh + kShFloats * i);
      std::fill_n(grads.means, 3 * m, 99.f);  // writable
    });
    rasterizer->BackwardInto(g, up, &consumer);
    EXPECT_EQ(rows, kCount);
    EXPECT_TRUE(SameBytes(pieces.means, whole.means));
    EXPECT_TRUE(SameBytes(pieces.log_scales, whole.log_scales));
    EXPECT_TRUE(SameBytes(pieces.quats, whole.quats));
    EXPECT_TRUE(SameBytes(pieces.opacity_logits, whole.opacity_logits));
    EXPECT_TRUE(SameBytes(pieces.sh, whole.sh));
  }
  SetNumThreads(0);
}

TEST(CpuRasterizer, LetsAConsumerChangeItsBlock) {
  constexpr int64_t kCount = 4 * kGradBlock;
  const RenderGrads up{Buffer<float>::Full({40, 50, 3}, 1.f), {}, {}};
  Gaussians still = RandomGaussians(kCount, 0.1, 9), moving = RandomGaussians(kCount, 0.1, 9);
  auto rasterizer = MakeRasterizer(kCpu);
  rasterizer->Forward(still, FrontCamera(50, 40), {}, RenderPass::kTrain);
  Gaussians whole = Gaussians::Zeros(kCount);
  rasterizer->Backward(still, up, &whole);
  Buffer<float> means = Buffer<float>::Zeros({kCount, 3});
  rasterizer->Forward(moving, FrontCamera(50, 40), {}, RenderPass::kTrain);
  BlockConsumer consumer([&](int64_t begin, int64_t end, const GaussianRows& grads) {
    std::copy_n(grads.means, 3 * (end - begin), means.data() + 3 * begin);
    const GaussianRows own = moving.Rows().From(begin);
    std::fill_n(own.means, 3 * (end - begin), 1e9f);
    std::fill_n(own.sh, kShFloats * (end - begin), 1e9f);
  });
  rasterizer->BackwardInto(moving, up, &consumer);
  EXPECT_TRUE(SameBytes(means, whole.means));
}

TEST(CpuRasterizer, SurvivesNanAndInfinity) {
  // Infinite, denormal and undefined numbers must neither crash nor reach another Gaussian's pixels' bits.
  Gaussians g = RandomGaussians(64, 0.1, 4);
  const float odd[] = {std::numeric_limits<float>::infinity(),
                       -std::numeric_limits<float>::infinity(),
                       std::numeric_limits<float>::quiet_NaN(),
                       1e38f,
                       -1e38f,
                       1e-40f};
  for (int i = 0; i < 6; ++i) {
    g.means.data()[3 * i + i % 3] = odd[i];
    g.log_scales.data()[3 * (i + 8)] = odd[i];
    g.quats.data()[4 * (i + 16)] = odd[i];
    g.opacity_logits.data()[i + 24] = odd[i];
  }
  auto rasterizer = MakeRasterizer(kCpu);
  rasterizer->Forward(g, FrontCamera(48, 48), {}, RenderPass::kTrain);
  Gaussians grads = Gaussians::Zeros(64);
  rasterizer->Backward(g, {Buffer<float>::Full({48, 48, 3}, 1.f), {}, {}}, &grads);
  EXPECT_TRUE(AllFinite(grads.means.Rows(32, 64)));
}

TEST(CpuRasterizer, ClampsExtremeOpacityLogits) {
  Gaussians g = RandomGaussians(2, 0.3, 4);
  Table(g.means).rowwise() = Eigen::Array3f(0, 0, 3).transpose();
  const auto solid = [&](float logit) {
    Flat(g.opacity_logits).setConstant(logit);
    return Flat(MakeRasterizer(kCpu)->Forward(g, FrontCamera(32, 32), {}, RenderPass::kInference).alpha).maxCoeff();
  };
  for (const float logit : {-100.f, -200.f, -1000.f}) EXPECT_EQ(solid(logit), 0) << logit;
  EXPECT_GT(solid(1000.f), 0.98f);
}

TEST(CpuRasterizer, RefusesWrongShapes) {
  auto rasterizer = MakeRasterizer(kCpu);
  Gaussians g = RandomGaussians(10, 0.1, 1);
  g.quats = Buffer<float>::Zeros({10, 3});
  EXPECT_THROW(rasterizer->Forward(g, FrontCamera(8, 8), {}, RenderPass::kTrain), ShapeError);
  g = RandomGaussians(10, 0.1, 1);
  EXPECT_THROW(rasterizer->Forward(g, FrontCamera(0, 8), {}, RenderPass::kTrain), ShapeError);
  Gaussians grads = Gaussians::Zeros(10);
  EXPECT_THROW(rasterizer->Backward(g, {}, &grads), ShapeError);  // no forward pass yet
  BlockConsumer never([](int64_t, int64_t, const GaussianRows&) { ADD_FAILURE() << "called"; });
  EXPECT_THROW(rasterizer->BackwardInto(g, {}, &never), ShapeError);
  rasterizer->Forward(g, FrontCamera(8, 8), {}, RenderPass::kTrain);
  EXPECT_THROW(rasterizer->Backward(g, {Buffer<float>::Zeros({8, 9, 3}), {}, {}}, &grads), ShapeError);
}

}  // namespace
}  // namespace oraclegs
