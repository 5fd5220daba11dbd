#include "bench/gpu_stereo.h"

#include "oraclegs/depth/cuda/cuda_plane_search.h"
#include "support/cuda_device.h"

namespace oraclegs {
namespace {

class GpuStereoTest : public CudaTest {};

TEST_F(GpuStereoTest, TheSearchIsAPartOfTheWhole) {
  const GpuStereo times = MeasureStereo(16, 12, cuda::MakeCudaPlaneSearch(0).get());
  EXPECT_GT(times.search_seconds, 0);
  EXPECT_GT(times.seconds, times.search_seconds);
}

}  // namespace
}  // namespace oraclegs
