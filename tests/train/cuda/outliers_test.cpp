#include "oraclegs/train/cuda/outliers.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "oraclegs/core/cuda/device_array.h"
#include "oraclegs/train/outliers.h"
#include "train/cuda/device_gaussians.h"
#include "train/small_scene.h"

namespace oraclegs::cuda {
namespace {

constexpr int64_t kFloaterCount = 500;

class CudaFloaters : public CudaTest {
 protected:
  std::vector<TrainView> views;
  std::vector<Buffer<float>> kept;  // what the views on the device point to
  Gaussians start = RandomGaussians(kFloaterCount, 3);
  DeviceArray<DepthView> depth_views{"a test"};
  DeviceArray<uint8_t> floats{"a test"};
  DeviceArray<int> counts{"a test"};

  /// A wall at distance 3 from each of four cameras, unknown here and there.
  void SetUp() override {
    CudaTest::SetUp();
    views = Photos(4);
    uint64_t seed = 5;
    for (TrainView& view : views) {
      view.inv_depth = Buffer<float>::Full({kHeight, kWidth}, 1 / 3.f);
      view.depth_mask = Above(RandomUniform({kHeight, kWidth}, seed++), 0.2f);
    }
    Table(views[3].inv_depth).leftCols(5).setZero();
    views.push_back(Photos(1)[0]);  // without depth
  }

  FloatersInput Input(const Gaussians& gaussians) {
    std::vector<DepthView> all;
    for (const TrainView& view : views) {
      if (!view.inv_depth.defined()) continue;
      DepthView out{};
      const Eigen::Matrix4d pose = view.camera.cam_from_world.matrix();
      for (int i = 0; i < 12; ++i) out.cam_from_world[i] = pose(i / 4, i % 4);
      out.fx = view.camera.fx, out.fy = view.camera.fy, out.cx = view.camera.cx, out.cy = view.camera.cy;
      out.width = view.camera.width, out.height = view.camera.height;
      kept.push_back(OnTestDevice(view.inv_depth));
      out.inv_depth = kept.back().data();
      kept.push_back(OnTestDevice(view.depth_mask));
      out.depth_mask = {kept.back().data(), false};
      all.push_back(out);
    }
    depth_views.Upload(all.data(), static_cast<int64_t>(all.size()));
    floats.Reserve(kFloaterCount);
    counts.Reserve(2);
    return {gaussians.Rows(), kFloaterCount, depth_views.data(), static_cast<int>(all.size()),
            floats.data(),    counts.data()};
  }
};

TEST_F(CudaFloaters, AreTheCpus) {
  Gaussians expected = start.Clone();
  const int64_t pruned = PruneFloaters(views, &expected);
  ASSERT_GT(pruned, 10);
  const Gaussians gaussians = OnTestDevice(start);
  RunPruneFloaters(Input(gaussians), nullptr);
  EXPECT_TRUE(SameBits(OnHost(gaussians), expected));
  EXPECT_EQ(ToHost(counts, 2)[1], pruned);
}

TEST_F(CudaFloaters, NothingHappensWhenAllWouldDie) {
  start.means.SetZero();
  Table(start.means).col(2).setConstant(-1);  // before the walls of all
  Gaussians expected = start.Clone();
  ASSERT_EQ(PruneFloaters({views[0]}, &expected), 0);
  views.resize(1);
  Flat(views[0].depth_mask).setConstant(1);
  const Gaussians gaussians = OnTestDevice(start);
  RunPruneFloaters(Input(gaussians), nullptr);
  EXPECT_TRUE(SameBits(OnHost(gaussians), start));
  EXPECT_EQ(ToHost(counts, 2)[0], ToHost(counts, 2)[1]);
}

class CudaScaleCap : public CudaTest {};

TEST_F(CudaScaleCap, IsTheCpus) {
  const Gaussians start = RandomGaussians(500, 3);
  Flat(start.log_scales) += 2;
  const std::vector<float> centers = CameraCenters(Photos(4));
  Gaussians expected = start.Clone();
  CapScales(centers, 0.7, &expected);
  ASSERT_FALSE(Equal(expected.log_scales, start.log_scales));
  DeviceArray<float> on_device("a test");
  on_device.Upload(centers.data(), static_cast<int64_t>(centers.size()));
  const Gaussians gaussians = OnTestDevice(start);
  const auto log_share = static_cast<float>(std::log(0.7));
  RunCapScales({gaussians.Rows(), 500, on_device.data(), 4, log_share}, nullptr);
  EXPECT_LE(MaxAbsError(OnHost(gaussians.log_scales), expected.log_scales), 1e-5);
  RunCapScales({gaussians.Rows(), 500, nullptr, 0, log_share}, nullptr);
  EXPECT_LE(MaxAbsError(OnHost(gaussians.log_scales), expected.log_scales), 1e-5);
}

}  // namespace

}  // namespace oraclegs::cuda
