#include "oraclegs/train/train_device.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "train/cuda/device_gaussians.h"
#include "train/small_scene.h"
#if defined(ORACLEGS_EMULATED_CUDA)
#include "support/emulated_cuda/runtime.h"
#endif

namespace oraclegs::cuda {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// Options under which every kind of event happens within 60 iterations.
TrainOptions AllAtOnce() {
  TrainOptions options = Options(60);
  options.exposure = ExposureMode::kOn;
  options.opacity_noise = 0.3;
  options.dropout = 0.1;
  options.prune_floaters = true;
  return options;
}

TrainingData AllData() {
  TrainingData data(Photos(3), Photos(2));
  for (TrainView& view : data.photos) {
    view.inv_depth = Buffer<float>::Full({kHeight, kWidth}, 0.4f);
    view.depth_mask = Buffer<float>::Full({kHeight, kWidth}, 1.f);
  }
  data.proposals[1].pixel_weight = Buffer<float>::Full({kHeight, kWidth}, 0.5f);
  return data;
}

Trainer GpuTrainer(const TrainOptions& options, TrainingData data) {
  return Trainer({options, kSeed, {0.1f, 0.2f, 0.3f}, std::move(data), Start()},
                 [](const TrainDeviceSetup& setup) { return MakeCudaTrainDevice(TestDevice(), setup); });
}

class CudaTrainDeviceTest : public CudaTest {};

TEST_F(CudaTrainDeviceTest, TrainsAsTheCpuDoes) {
  const TrainOptions options = AllAtOnce();
  Trainer expected(options, kSeed, {0.1f, 0.2f, 0.3f}, AllData(), Start());
  Trainer trainer = GpuTrainer(options, AllData());
  for (int i = 1; i <= 45; ++i) {
    const double wanted = expected.Step();
    EXPECT_NEAR(trainer.Step(), wanted, 1e-3 * wanted) << i;
    if (i == 10) ExpectClose(OnHost(trainer.gaussians()), expected.gaussians(), 5e-3);
  }
  EXPECT_EQ(trainer.gaussians().size(), expected.gaussians().size());
  EXPECT_GT(trainer.gaussians().size(), 60);  // has grown
  const std::vector<ExposureMap> maps = trainer.exposures(), expected_maps = expected.exposures();
  ASSERT_EQ(maps.size(), 3u);
  for (size_t i = 0; i < maps.size(); ++i) {
    for (int k = 0; k < 12; ++k) EXPECT_NEAR(maps[i][k], expected_maps[i][k], 1e-3) << i << " " << k;
  }
}

TEST_F(CudaTrainDeviceTest, TheSameSeedGivesTheSameBits) {
  Trainer a = GpuTrainer(AllAtOnce(), AllData()), b = GpuTrainer(AllAtOnce(), AllData());
  for (int i = 1; i <= 45; ++i) EXPECT_EQ(a.Step(), b.Step());
  EXPECT_TRUE(SameBits(OnHost(a.gaussians()), OnHost(b.gaussians())));
}

TEST_F(CudaTrainDeviceTest, ACheckpointContinuesToTheSameBits) {
  Trainer whole = GpuTrainer(AllAtOnce(), AllData()), first = GpuTrainer(AllAtOnce(), AllData());
  for (int i = 0; i < 55; ++i) whole.Step();
  for (int i = 0; i < 35; ++i) first.Step();
  const Checkpoint checkpoint = first.MakeCheckpoint();
  EXPECT_EQ(checkpoint.gaussians.device(), kCpu);
  EXPECT_GT(checkpoint.loss, 0);
  Trainer second = GpuTrainer(AllAtOnce(), AllData());
  second.Restore(checkpoint);
  for (int i = 0; i < 20; ++i) second.Step();
  EXPECT_TRUE(SameBits(OnHost(second.gaussians()), OnHost(whole.gaussians())));
  EXPECT_EQ(second.MakeCheckpoint().loss, whole.MakeCheckpoint().loss);
  EXPECT_EQ(second.MakeCheckpoint().adam.step, 55);
  EXPECT_EQ(second.exposures(), whole.exposures());
}

TEST_F(CudaTrainDeviceTest, TheCpuContinuesItsCheckpoints) {
  Trainer gpu = GpuTrainer(AllAtOnce(), AllData());
  for (int i = 0; i < 35; ++i) gpu.Step();
  Trainer cpu(AllAtOnce(), kSeed, {0.1f, 0.2f, 0.3f}, AllData(), Start());
  cpu.Restore(gpu.MakeCheckpoint());
  EXPECT_NEAR(cpu.Step(), gpu.Step(), 1e-4);
}

TEST_F(CudaTrainDeviceTest, RunsToTheEndWithoutAskingForEachLoss) {
  Trainer trainer = GpuTrainer(AllAtOnce(), AllData());
  const TrainResult result = trainer.Run({}, Silent());
  EXPECT_EQ(result.iterations, 60);
  Trainer stepped = GpuTrainer(AllAtOnce(), AllData());
  for (int i = 0; i < 60; ++i) stepped.Step();
  EXPECT_TRUE(SameBits(OnHost(trainer.gaussians()), OnHost(stepped.gaussians())));
}

TEST_F(CudaTrainDeviceTest, NamesTheIterationWhoseLossBroke) {
  TrainOptions options = Options(60);
  TrainingData data(Photos(1));
  data.photos[0].image[(3 * kWidth + 3) * 3] = std::nanf("");
  Trainer trainer = GpuTrainer(options, data);
  try {
    trainer.Run({}, Silent());
    FAIL() << "a loss that is not a number must not pass";
  } catch (const RunError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("loss is"), HasSubstr("iteration 1 on photo0")));
  }
}

#if defined(ORACLEGS_EMULATED_CUDA)
TEST_F(CudaTrainDeviceTest, AnIterationTakesNoMemoryAndWaitsTwice) {
  TrainOptions options = AllAtOnce();
  options.max_gaussians = 60;
  Trainer trainer = GpuTrainer(options, AllData());
  for (int i = 0; i < 20; ++i) trainer.Step();
  const emulated_cuda::Counts before = emulated_cuda::CountCalls();
  for (int i = 0; i < 5; ++i) trainer.Step();
  const emulated_cuda::Counts after = emulated_cuda::CountCalls();
  EXPECT_EQ(after.allocations, before.allocations);
  EXPECT_EQ(after.waits, before.waits + 5 * (2 + 1));  // for two counts of the rasterizer, and the loss that Step gives
}

TEST_F(CudaTrainDeviceTest, RefusesWhatWillNotFitBeforeItBegins) {
  TrainOptions options = Options();
  options.max_gaussians = 100000000;
  emulated_cuda::SetMemory(size_t{1} << 34);
  try {
    GpuTrainer(options, Photos(1));
    ADD_FAILURE() << "80 GB must not fit into 17";
  } catch (const RunError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("training needs about"), HasSubstr("Gaussians and their moments"),
                                    HasSubstr("are free"), HasSubstr("--max-gaussians")));
  }
  emulated_cuda::SetMemory(size_t{1} << 40);
}
#endif

}  // namespace
}  // namespace oraclegs::cuda
