#include <memory>

#include "oraclegs/render/render.h"
#include "oraclegs/train/trainer.h"
#include "support/allocations.h"
#include "support/buffers.h"
#include "train/gaussian_fixtures.h"

namespace oraclegs {
namespace {

constexpr int kWarmUp = 40, kCounted = 20;

/// Photos of two sizes, one with a mask.
std::vector<TrainView> SmallPhotos() {
  auto rasterizer = MakeRasterizer(kCpu);
  std::vector<TrainView> views;
  for (int i = 0; i < 4; ++i) {
    const int width = i % 2 ? 70 : 41, height = i % 2 ? 51 : 64;
    TrainView view{"photo", {width, height, 50, 50, width / 2.0, height / 2.0, Eigen::Isometry3d::Identity()}, {}, {}};
    view.camera.cam_from_world.translation() = Eigen::Vector3d(0.1 * i, 0, 5);
    view.image = rasterizer->Forward(RandomGaussians(50, 7), view.camera, {}, RenderPass::kInference).image.Clone();
    views.push_back(view);
  }
  views[3].pixel_weight = Buffer<float>::Full({51, 70}, 1.f);
  Table(views[3].pixel_weight).middleCols(30, 20).setZero();
  return views;
}

TEST(AllocationCounterTest, SeesTheHeapsFunctions) {
  if (!AllocationCounter::Works()) GTEST_SKIP() << "needs glibc and no sanitizer";
  const auto count = [](auto&& body) {
    AllocationCounter::Begin();
    body();
    return AllocationCounter::End();
  };
  struct alignas(128) Wide {
    int x = 0;
  };
  EXPECT_EQ(count([] {}), 0);
  std::unique_ptr<int> one;
  EXPECT_EQ(count([&] { one = std::make_unique<int>(1); }), 1);
  EXPECT_THAT(AllocationCounter::First(), testing::HasSubstr("train_tests"));
  std::unique_ptr<Wide> wide;
  EXPECT_EQ(count([&] { wide = std::make_unique<Wide>(); }), 1);
  Buffer<float> tensor;
  EXPECT_GE(count([&] { tensor = Buffer<float>::Empty({5}); }), 1);
}

/// Proposals of the two sizes, with confidence; one with depth.
std::vector<TrainView> Proposals() {
  std::vector<TrainView> views = SmallPhotos();
  for (TrainView& view : views) view.pixel_weight = RandomUniform({view.camera.height, view.camera.width}, 114);
  views[1].inv_depth = views[1].depth_mask = Buffer<float>::Full({51, 70}, 0.2f);
  return views;
}

void ExpectNoAllocation(const TrainingData& data) {
  for (const int threads : {1, 4}) {
    const Threads scope(threads);
    TrainOptions options;
    options.iterations = 1000;
    options.max_gaussians = 2000;
    options.sh_degree_interval = 5;
    options.scale_reg = 10;  // Gaussians shrink, so that no list grows once all views have been seen
    options.opacity_reg = 0;
    options.schedule = ScheduleKind::kConstant;
    options.synthetic_floor = 0.5;
    Trainer trainer(options, 1, {0, 0, 0}, data, RandomGaussians(2000, 3));
    for (int i = 0; i < kWarmUp; ++i) trainer.Step();
    AllocationCounter::Begin();
    for (int i = 0; i < kCounted; ++i) trainer.Step();
    EXPECT_EQ(AllocationCounter::End(), 0) << "with " << threads << " threads, the first at\n"
                                           << AllocationCounter::First();
  }
}

TEST(TrainerAllocationsTest, AnIterationAllocatesNothing) {
  if (!AllocationCounter::Works()) GTEST_SKIP() << "needs glibc and no sanitizer";
  ExpectNoAllocation(SmallPhotos());
}

TEST(TrainerAllocationsTest, NorDoesOneOfAProposal) {
  if (!AllocationCounter::Works()) GTEST_SKIP() << "needs glibc and no sanitizer";
  ExpectNoAllocation({SmallPhotos(), Proposals()});
}

}  // namespace
}  // namespace oraclegs
