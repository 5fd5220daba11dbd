// What a new densifier costs: a class, and the setup that it is named in. It runs on a CPU and on a GPU.

#include <gtest/gtest.h>

#include "oraclegs/train/train_device.h"
#include "train/cuda/device_gaussians.h"
#include "train/small_scene.h"

namespace oraclegs {
namespace {

/// Doubles the first Gaussians, one more each time, and removes the last one.
class ToyDensifier final : public Densifier {
 public:
  void Refine(const Iteration&, TrainedModel* model) override {
    ++refined_;
    OnHost(model, [&](TrainedModel* host) {
      std::vector<int64_t> rows;
      for (int64_t i = 0; i + 1 < host->gaussians.size(); ++i) rows.push_back(i);
      for (int64_t i = 0; i < refined_; ++i) rows.push_back(i);
      KeepRows(rows, &host->gaussians, &host->adam);
    });
  }
  void Save(NamedState* state) const override {
    state->arrays["toy"] = Buffer<float>::From({1}, {static_cast<float>(refined_)});
  }
  void Restore(const NamedState& state, int64_t) override {
    refined_ = static_cast<int64_t>(state.Array("toy", {1})[0]);
  }

 private:
  int64_t refined_ = 0;
};

/// A trainer of the small scene with the toy.
Trainer ToyTrainer(const TrainDeviceMaker& make_device) {
  TrainSetup setup{Options(), kSeed, {0, 0, 0}, Photos(2), Start()};
  setup.densifier = [](const DensifierSetup&) { return std::make_unique<ToyDensifier>(); };
  return Trainer(std::move(setup), make_device);
}

std::unique_ptr<TrainDevice> ToyOnCpu(const TrainDeviceSetup& setup) { return MakeTrainDevice(kCpu, setup); }
std::unique_ptr<TrainDevice> ToyOnGpu(const TrainDeviceSetup& setup) {
  return cuda::MakeCudaTrainDevice(TestDevice(), setup);
}

class ToyDensifierTest : public CudaTest {};

TEST_F(ToyDensifierTest, RefinesOnBothDevices) {
  Trainer cpu = ToyTrainer(ToyOnCpu), gpu = ToyTrainer(ToyOnGpu);
  for (int i = 0; i < 65; ++i) EXPECT_NEAR(gpu.Step(), cpu.Step(), 1e-3);
  EXPECT_EQ(cpu.gaussians().size(), 60 + (1 - 1) + (2 - 1) + (3 - 1));  // at 40, 50 and 60
  EXPECT_EQ(gpu.gaussians().size(), cpu.gaussians().size());
}

TEST_F(ToyDensifierTest, GoesOnFromCheckpointsOfEitherDevice) {
  for (const auto& make_device : {ToyOnCpu, ToyOnGpu}) {
    Trainer whole = ToyTrainer(make_device), first = ToyTrainer(make_device), second = ToyTrainer(make_device);
    for (int i = 0; i < 55; ++i) whole.Step();
    for (int i = 0; i < 45; ++i) first.Step();
    second.Restore(first.MakeCheckpoint());
    for (int i = 0; i < 10; ++i) second.Step();
    EXPECT_TRUE(SameBits(OnHost(second.gaussians()), OnHost(whole.gaussians())));
  }
}

}  // namespace
}  // namespace oraclegs
