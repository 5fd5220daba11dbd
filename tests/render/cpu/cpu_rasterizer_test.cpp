// The promises of render.h: bits, buffers, shapes, odd numbers.

#include <algorithm>
#include <atomic>
#include <cstring>

#include "oraclegs/core/parallel.h"
#include "oraclegs/render/render.h"
#include "render/scenes.h"
#include "support/golden.h"

namespace oraclegs {
namespace {

bool SameBits(const Buffer<float>& a, const Buffer<float>& b) {
  return a.shape() == b.shape() && std::memcmp(a.data_ptr(), b.data_ptr(), a.nbytes()) == 0;
}

TEST(CpuRasterizer, SameBitsForAnyNumberOfThreads) {
  const Gaussians g = RandomGaussians(20000, 0.05, 3);
  const Camera camera = FrontCamera(150, 110);
  torch::manual_seed(2);
  const RenderGrads up{torch::randn({110, 150, 3}), torch::randn({110, 150}), torch::randn({110, 150})};
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
    EXPECT_TRUE(SameBits(one.image, many.image));
    EXPECT_TRUE(SameBits(one.inv_depth, many.inv_depth));
    EXPECT_TRUE(SameBits(one_grads.means, many_grads.means));
    EXPECT_TRUE(SameBits(one_grads.log_scales, many_grads.log_scales));
    EXPECT_TRUE(SameBits(one_grads.quats, many_grads.quats));
    EXPECT_TRUE(SameBits(one_grads.opacity_logits, many_grads.opacity_logits));
    EXPECT_TRUE(SameBits(one_grads.sh, many_grads.sh));
  }
  SetNumThreads(0);
}

TEST(CpuRasterizer, BuffersOfALargerViewDoNotLeakIntoASmallerOne) {
  auto rasterizer = MakeRasterizer(kCpu);
  rasterizer->Forward(RandomGaussians(5000, 0.1, 1), FrontCamera(200, 160), {}, RenderPass::kTrain);
  const Gaussians g = RandomGaussians(300, 0.1, 2);
  const RenderOutput reused = rasterizer->Forward(g, FrontCamera(40, 30), {}, RenderPass::kTrain);
  const RenderOutput fresh = MakeRasterizer(kCpu)->Forward(g, FrontCamera(40, 30), {}, RenderPass::kTrain);
  EXPECT_TRUE(SameBits(reused.image, fresh.image));
  EXPECT_TRUE(SameBits(reused.inv_depth, fresh.inv_depth));
}

TEST(CpuRasterizer, HigherCoefficientsAreNeitherReadNorWritten) {
  Gaussians g = RandomGaussians(200, 0.1, 9);
  g.sh.slice(1, 4).fill_(std::numeric_limits<float>::quiet_NaN());
  auto rasterizer = MakeRasterizer(kCpu);
  const RenderOutput out = rasterizer->Forward(g, FrontCamera(32, 32), {{0, 0, 0}, 1, false}, RenderPass::kTrain);
  EXPECT_TRUE(torch::isfinite(out.image).all().item<bool>());
  Gaussians grads = Gaussians::Zeros(200);
  grads.sh.fill_(7);
  rasterizer->Backward(g, {Buffer<float>::Full({32, 32, 3}, 1.f), {}, {}}, &grads);
  EXPECT_EQ(grads.sh.slice(1, 4).min().item<float>(), 7);
  EXPECT_TRUE(torch::isfinite(grads.sh).all().item<bool>());
}

TEST(CpuRasterizer, BlocksHoldTheBitsOfTheWholeAndComeOnceEach) {
  constexpr int64_t kCount = 5 * kGradBlock + 37;
  Gaussians g = RandomGaussians(kCount, 0.1, 9);
  g.means.narrow(0, 2 * kGradBlock, kGradBlock).fill_(-5.f);  // a block behind the camera
  const RenderGrads up{Buffer<float>::Full({40, 50, 3}, 1.f), {}, {}};
  auto rasterizer = MakeRasterizer(kCpu);
  rasterizer->Forward(g, FrontCamera(50, 40), {{0, 0, 0}, 2, false}, RenderPass::kTrain);
  Gaussians whole = Gaussians::Zeros(kCount);
  rasterizer->Backward(g, up, &whole);
  EXPECT_GT(whole.sh.abs().max().item<float>(), 0);
  for (const int threads : {1, 3}) {
    SetNumThreads(threads);
    Gaussians pieces = Gaussians::Empty(kCount);
    pieces.ForEach([](const char*, Buffer<float>& t) { t.fill_(-7.f); });
    pieces.sh.slice(1, 9).SetZero();
    const GaussianRows all = pieces.Rows();
    std::atomic<int64_t> rows = 0;
    rasterizer->BackwardBlocks(g, up, [&](int64_t begin, int64_t end, const GaussianRows& grads) {
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
    EXPECT_EQ(rows, kCount);
    EXPECT_TRUE(SameBits(pieces.means, whole.means));
    EXPECT_TRUE(SameBits(pieces.log_scales, whole.log_scales));
    EXPECT_TRUE(SameBits(pieces.quats, whole.quats));
    EXPECT_TRUE(SameBits(pieces.opacity_logits, whole.opacity_logits));
    EXPECT_TRUE(SameBits(pieces.sh, whole.sh));
  }
  SetNumThreads(0);
}

TEST(CpuRasterizer, ABlockMayBeMovedWhileOthersAreDifferentiated) {
  constexpr int64_t kCount = 4 * kGradBlock;
  const RenderGrads up{Buffer<float>::Full({40, 50, 3}, 1.f), {}, {}};
  Gaussians still = RandomGaussians(kCount, 0.1, 9), moving = RandomGaussians(kCount, 0.1, 9);
  auto rasterizer = MakeRasterizer(kCpu);
  rasterizer->Forward(still, FrontCamera(50, 40), {}, RenderPass::kTrain);
  Gaussians whole = Gaussians::Zeros(kCount);
  rasterizer->Backward(still, up, &whole);
  Buffer<float> means = Buffer<float>::Zeros({kCount, 3});
  rasterizer->Forward(moving, FrontCamera(50, 40), {}, RenderPass::kTrain);
  rasterizer->BackwardBlocks(moving, up, [&](int64_t begin, int64_t end, const GaussianRows& grads) {
    std::copy_n(grads.means, 3 * (end - begin), means.data() + 3 * begin);
    const GaussianRows own = moving.Rows().From(begin);
    std::fill_n(own.means, 3 * (end - begin), 1e9f);
    std::fill_n(own.sh, kShFloats * (end - begin), 1e9f);
  });
  EXPECT_TRUE(SameBits(means, whole.means));
}

TEST(CpuRasterizer, OddParametersDoNoHarm) {
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
  EXPECT_TRUE(torch::isfinite(grads.means.slice(0, 32)).all().item<bool>());
}

TEST(CpuRasterizer, OpacityLogitsBeyondTheExponentialAreInvisibleOrSolid) {
  Gaussians g = RandomGaussians(2, 0.3, 4);
  g.means.copy_(torch::tensor({{0.f, 0.f, 3.f}, {0.f, 0.f, 3.f}}));
  for (const float logit : {-100.f, -200.f, -1000.f}) {
    g.opacity_logits.fill_(logit);
    EXPECT_EQ(MakeRasterizer(kCpu)
                  ->Forward(g, FrontCamera(32, 32), {}, RenderPass::kInference)
                  .alpha.max()
                  .item<float>(),
              0)
        << logit;
  }
  g.opacity_logits.fill_(1000.f);
  EXPECT_GT(MakeRasterizer(kCpu)
                ->Forward(g, FrontCamera(32, 32), {}, RenderPass::kInference)
                .alpha.max()
                .item<float>(),
            0.98f);
}

TEST(CpuRasterizer, WrongShapesAreRefusedByName) {
  auto rasterizer = MakeRasterizer(kCpu);
  Gaussians g = RandomGaussians(10, 0.1, 1);
  g.quats = Buffer<float>::Zeros({10, 3});
  EXPECT_THROW(rasterizer->Forward(g, FrontCamera(8, 8), {}, RenderPass::kTrain), ShapeError);
  g = RandomGaussians(10, 0.1, 1);
  EXPECT_THROW(rasterizer->Forward(g, FrontCamera(0, 8), {}, RenderPass::kTrain), ShapeError);
  Gaussians grads = Gaussians::Zeros(10);
  EXPECT_THROW(rasterizer->Backward(g, {}, &grads), ShapeError);  // no forward pass yet
  const auto never = [](int64_t, int64_t, const GaussianRows&) { ADD_FAILURE() << "called"; };
  EXPECT_THROW(rasterizer->BackwardBlocks(g, {}, never), ShapeError);
  rasterizer->Forward(g, FrontCamera(8, 8), {}, RenderPass::kTrain);
  EXPECT_THROW(rasterizer->Backward(g, {Buffer<float>::Zeros({8, 9, 3}), {}, {}}, &grads), ShapeError);
}

}  // namespace
}  // namespace oraclegs
