// Memory that ends on the way: what is said, and what is left. On the emulated device, whose allocator can be told to
// fail.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "oraclegs/train/train_device.h"
#include "support/temp_dir.h"
#include "train/cuda/device_gaussians.h"
#include "train/small_scene.h"
#if defined(ORACLEGS_EMULATED_CUDA)
#include "support/emulated_cuda/runtime.h"

namespace oraclegs::cuda {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr int64_t kPlenty = int64_t{1} << 40;

class OutOfMemoryTest : public CudaTest {
 protected:
  void SetUp() override {
    CudaTest::SetUp();
    options = Options(60);
    options.max_gaussians = 150;
    options.refine_start = 5;
    options.refine_every = 3;  // 60 Gaussians become twice as many, whose tile lists must grow
  }
  void TearDown() override { emulated_cuda::SetMemory(kPlenty); }

  Trainer MakeTrainer() const {
    return Trainer({options, kSeed, {0, 0, 0}, Photos(3), Start()},
                   [](const TrainDeviceSetup& setup) { return MakeCudaTrainDevice(TestDevice(), setup); });
  }
  CheckpointPolicy Policy(int64_t every) const { return {dir.path(), every, {{"iterations", 60}}}; }

  /// Message of Run when nothing more can be allocated after `steps` iterations.
  static std::string RunsOut(Trainer* trainer, int steps, const CheckpointPolicy& policy) {
    for (int i = 0; i < steps; ++i) trainer->Step();
    const DeviceMemory memory = MemoryOfDevice();
    emulated_cuda::SetMemory(static_cast<size_t>(memory.total - memory.free));
    try {
      trainer->Run(policy, Silent());
    } catch (const OutOfMemory& error) {
      emulated_cuda::SetMemory(kPlenty);
      return error.what();
    }
    return "";
  }

  TempDir dir;
  TrainOptions options;
};

TEST_F(OutOfMemoryTest, SaysWhatForAndNamesTheLastCheckpoint) {
  Trainer trainer = MakeTrainer();
  const std::string what = RunsOut(&trainer, 7, Policy(2));
  const auto newest = NewestCheckpoint(dir.path());
  ASSERT_TRUE(newest.has_value());
  EXPECT_THAT(what, AllOf(HasSubstr(fmt::format("iteration {} of 60: out of GPU memory", trainer.iteration() + 1)),
                          HasSubstr("GB for the "), HasSubstr("lower --max-gaussians"), HasSubstr(newest->string()),
                          HasSubstr("--device cpu"), testing::Not(HasSubstr("\n"))));
}

TEST_F(OutOfMemoryTest, TheLastCheckpointContinuesToTheSameBits) {
  Trainer whole = MakeTrainer();
  whole.Run({}, Silent());
  Trainer stopped = MakeTrainer();
  ASSERT_NE(RunsOut(&stopped, 7, Policy(2)), "");
  Trainer second = MakeTrainer();
  second.Restore(ReadCheckpoint(*NewestCheckpoint(dir.path())));
  second.Run(Policy(0), Silent());
  EXPECT_TRUE(SameBits(OnHost(second.gaussians()), OnHost(whole.gaussians())));
}

TEST_F(OutOfMemoryTest, SaysWhenNothingHadBeenSaved) {
  Trainer trainer = MakeTrainer(), other = MakeTrainer();
  EXPECT_THAT(RunsOut(&trainer, 6, Policy(0)), HasSubstr("no checkpoint had been saved yet (--checkpoint-every)"));
  EXPECT_THAT(RunsOut(&other, 6, {}), HasSubstr("; nothing was saved"));
}

}  // namespace
}  // namespace oraclegs::cuda
#endif
