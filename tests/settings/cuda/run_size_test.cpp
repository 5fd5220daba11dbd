// The sizes that fit into the memory of a GPU by the estimate do fit: training begins on an emulated device that has no
// more.

#include "oraclegs/settings/run_size.h"

#include <gtest/gtest.h>

#include "oraclegs/settings/from_results.h"
#include "oraclegs/train/train_device.h"
#include "train/cuda/device_gaussians.h"
#include "train/small_scene.h"
#if defined(ORACLEGS_EMULATED_CUDA)
#include "support/emulated_cuda/runtime.h"

namespace oraclegs::cuda {
namespace {

constexpr SceneSize kScene{6, {640, 480}};

/// Views of this size, nothing but gray.
std::vector<TrainView> GrayViews(int count, PixelSize size, bool are_proposals) {
  TrainView view{"gray", CameraOnCircle(0), {}, {}};
  view.camera = Resized(view.camera, size.width, size.height);
  if (are_proposals) {
    view.image_bytes = Buffer<uint8_t>::Full({size.height, size.width, 3}, 128);
    view.weight_bytes = Buffer<uint8_t>::Full({size.height, size.width}, 200);
  } else {
    view.image = Buffer<float>::Full({size.height, size.width, 3}, 0.3f);
    view.inv_depth = Buffer<float>::Full({size.height, size.width}, 0.3f);
    view.depth_mask = Buffer<float>::Full({size.height, size.width}, 0.7f);
  }
  return std::vector<TrainView>(static_cast<size_t>(count), view);
}

class GpuSizeTest : public CudaTest, public testing::WithParamInterface<int64_t> {
 protected:
  void TearDown() override { emulated_cuda::SetMemory(size_t{1} << 40); }
};

TEST_P(GpuSizeTest, Fits) {
  const int64_t free = GetParam();
  const RunOptions settled = WithSize({}, kScene, {true, free});
  const PixelSize size = WorkingSize(kScene.largest, settled.image.Settled());
  TrainOptions options = SettleTraining(settled.train, {}, Silent());
  options.iterations = 2;
  const DeviceMemory memory = MemoryOfDevice();
  emulated_cuda::SetMemory(static_cast<size_t>(memory.total - memory.free + free));
  Trainer trainer({options,
                   kSeed,
                   {0, 0, 0},
                   {GrayViews(kScene.views, size, false), GrayViews(kMostProposals, size, true)},
                   Start()},
                  [](const TrainDeviceSetup& setup) { return MakeCudaTrainDevice(TestDevice(), setup); });
  EXPECT_NO_THROW(trainer.Step());
  EXPECT_GT(GpuBytes(settled, kScene), free / 4) << "far too careful";
}

INSTANTIATE_TEST_SUITE_P(Cards, GpuSizeTest, testing::Values(1'000'000'000, 500'000'000, 250'000'000));

}  // namespace
}  // namespace oraclegs::cuda
#endif
