#include "bench/gpu_once.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "oraclegs/depth/plane_search.h"
#include "support/cuda_device.h"

namespace oraclegs {
namespace {

class MeasureOnceTest : public CudaTest {};

TEST_F(MeasureOnceTest, NeighborsTakeTimeOnBothDevices) {
  const OnBoth times = MeasureNeighbors(100, 1);
  EXPECT_GT(times.gpu, 0);
  EXPECT_GT(times.cpu, 0);
}

TEST_F(MeasureOnceTest, WarpTakesTimeOnBothDevices) {
  const OnBoth times = MeasureWarp({3, 16, 12}, 1);
  EXPECT_GT(times.gpu, 0);
  EXPECT_GT(times.cpu, 0);
}

TEST_F(MeasureOnceTest, StereoTakesLongerThanItsSearch) {
  const GpuStereo times = MeasureStereo(16, 12, cuda::MakeCudaPlaneSearch(0).get());
  EXPECT_GT(times.search_seconds, 0);
  EXPECT_GT(times.seconds, times.search_seconds);
}

TEST(OnBothText, NamesBothDevices) {
  EXPECT_EQ(OnBothText("neighbors", {0.25, 30}), "neighbors: 0.2 ms, on the CPU 30 ms\n");
}

TEST(StereoText, NamesTheSearch) {
  EXPECT_EQ(StereoText({1.25, 0.75}), "stereo: 1.250 s an image, 0.750 s of it the search on the GPU\n");
}

TEST(OnceJson, HasBothTimesOfEachPart) {
  EXPECT_EQ(OnBothToJson("warp", {4, 5000}), (nlohmann::json{{"warp_ms", 4}, {"warp_cpu_ms", 5000}}));
  EXPECT_EQ(StereoToJson({1.25, 0.75}), (nlohmann::json{{"stereo_seconds", 1.25}, {"stereo_search_seconds", 0.75}}));
}

}  // namespace
}  // namespace oraclegs
