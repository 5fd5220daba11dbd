// The trainer uses gradients up block by block; the result must be what the parts give one after the other.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "oraclegs/camera/scene_bounds.h"
#include "oraclegs/gaussians/initialize.h"
#include "oraclegs/loss/photometric.h"
#include "oraclegs/render/render.h"
#include "oraclegs/train/mcmc.h"
#include "oraclegs/train/noise.h"
#include "oraclegs/train/regularizers.h"
#include "oraclegs/train/schedule.h"
#include "oraclegs/train/trainer.h"
#include "support/buffers.h"
#include "train/gaussian_fixtures.h"

namespace oraclegs {
namespace {

constexpr uint64_t kFusedSeed = 5;
constexpr int64_t kCount = 3 * kGradBlock + 21;  // neither whole blocks nor whole vectors

std::vector<TrainView> FarPhotos() {
  std::vector<TrainView> views;
  auto rasterizer = MakeRasterizer(kCpu);
  for (int i = 0; i < 3; ++i) {
    TrainView view{"photo" + std::to_string(i), {45, 33, 40, 40, 22, 16, Eigen::Isometry3d::Identity()}, {}, {}};
    view.camera.cam_from_world.translation() = Eigen::Vector3d(0.1 * i, 0, 5);
    view.image = rasterizer->Forward(RandomGaussians(50, 7), view.camera, {}, RenderPass::kInference).image.Clone();
    views.push_back(view);
  }
  return views;
}

TrainOptions ShortOptions() {
  TrainOptions options;
  options.iterations = 30;
  options.max_gaussians = 2 * kCount;
  options.sh_degree_interval = 4;
  options.refine_start = 5;
  options.refine_every = 8;
  return options;
}

/// Iterations without fusing: each part over all Gaussians, one after the other.
class SlowTrainer {
 public:
  explicit SlowTrainer(const Gaussians& start)
      : gaussians_(start.Clone()),
        adam_(start.size(), ShortOptions().sh_moments),
        sampler_(kFusedSeed, 3, 0),
        extent_(Extent()) {}

  double Step(int64_t i) {
    const TrainOptions options = ShortOptions();
    const LearningRates rates{MeansLearningRate(i, options.iterations, extent_)};
    const int degree = ActiveShDegree(i, options.sh_degree_interval);
    const TrainView& view = views_[sampler_.Next(0).index];
    const RenderOutput out = rasterizer_->Forward(gaussians_, view.camera, {{}, degree, false}, RenderPass::kTrain);
    Buffer<float> grad_image = Buffer<float>::Empty(out.image.shape());
    const double photometric = PhotometricLoss()(out.image, view.image, {}, {0.8f, 0.2f}, &grad_image).loss;
    Gaussians grads = Gaussians::Zeros(gaussians_.size());
    rasterizer_->Backward(gaussians_, {grad_image, {}, {}}, &grads);
    const double loss = photometric + AddRegularizers(gaussians_, {options.opacity_reg, options.scale_reg}, &grads);
    if (i == options.iterations) return loss;
    adam_.Step(grads, rates, degree, &gaussians_);
    if (i == 8 || i == 16 || i == 24) {
      moved_ += RelocateDead(kFusedSeed, i, &gaussians_, &adam_);
      AddGaussians(kFusedSeed, i, options.max_gaussians, &gaussians_, &adam_);
    }
    AddNoise({kFusedSeed, i, rates.means}, &gaussians_);
    return loss;
  }

  const Gaussians& gaussians() const { return gaussians_; }
  const Adam& adam() const { return adam_; }
  int64_t moved() const { return moved_; }

 private:
  double Extent() const {
    std::vector<Camera> cameras;
    for (const TrainView& view : views_) cameras.push_back(view.camera);
    return SpatialExtent(cameras);
  }

  std::vector<TrainView> views_ = FarPhotos();
  std::unique_ptr<Rasterizer> rasterizer_ = MakeRasterizer(kCpu);
  Gaussians gaussians_;
  Adam adam_;
  ViewSampler sampler_;
  double extent_;
  int64_t moved_ = 0;
};

TEST(TrainerFusedTest, GivesTheBitsOfItsPartsOneAfterTheOther) {
  Gaussians start = RandomGaussians(kCount, 3);
  Flat(start.opacity_logits).head(9).setConstant(-6);  // dead
  for (const int threads : {1, 3}) {
    const Threads scope(threads);
    SlowTrainer slow(start);
    Trainer fused(ShortOptions(), kFusedSeed, {0, 0, 0}, FarPhotos(), start);
    for (int64_t i = 1; i <= ShortOptions().iterations; ++i) {
      ASSERT_EQ(fused.Step(), slow.Step(i)) << i;
      ASSERT_TRUE(SameBits(fused.gaussians(), slow.gaussians())) << i;
    }
    const Checkpoint end = fused.MakeCheckpoint();
    EXPECT_TRUE(SameBits(end.adam.m, slow.adam().m));
    EXPECT_TRUE(SameBits(end.adam.v, slow.adam().v));
    EXPECT_TRUE(Equal(end.adam.sh_m, slow.adam().sh_m));
    EXPECT_TRUE(Equal(end.adam.sh_v_half, slow.adam().sh_v_half));
    EXPECT_EQ(end.adam.step, slow.adam().step);
    EXPECT_GT(slow.moved(), 0);
    EXPECT_GT(end.gaussians.size(), kCount);
    EXPECT_GT(MaxAbsError(end.gaussians.sh.Rows(0, kCount), start.sh), 0);
  }
}

}  // namespace
}  // namespace oraclegs
