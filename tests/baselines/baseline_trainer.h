#pragma once
// The small scene (train/small_scene.h), trained by a published method.

#include "oraclegs/baselines/methods.h"
#include "oraclegs/train/train_device.h"
#include "train/small_scene.h"

namespace oraclegs {

inline std::unique_ptr<TrainDevice> OnTheCpu(const TrainDeviceSetup& setup) { return MakeTrainDevice(kCpu, setup); }

/// A setup on a CPU.
inline BaselineSetup SmallSetup(const TrainOptions& options, std::vector<TrainView> photos, Gaussians start = Start()) {
  BaselineSetup setup{{options, kSeed, {0, 0, 0}, std::move(photos), std::move(start)}};
  setup.make_device = OnTheCpu;
  return setup;
}

/// The trainer of a setup with the densifier and parts of its method.
inline Trainer BaselineTrainer(BaselineSetup setup) {
  AddBaseline(&setup);
  const TrainDeviceMaker make_device = setup.make_device;
  return Trainer(std::move(setup), make_device);
}

}  // namespace oraclegs
