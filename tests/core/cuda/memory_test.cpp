#include "oraclegs/core/cuda/memory.h"

#include <gmock/gmock.h>

#include "oraclegs/core/cuda/check.h"
#include "oraclegs/core/error.h"
#include "support/cuda_device.h"
#include "support/errors.h"
#if defined(ORACLEGS_EMULATED_CUDA)
#include "support/emulated_cuda/runtime.h"
#endif

namespace oraclegs::cuda {
namespace {

using testing::HasSubstr;

class CudaMemory : public CudaTest {};

TEST_F(CudaMemory, TooMuchSaysHowMuchForWhatAndTheMend) {
  const std::string what = MessageOf<RunError>([] { AllocateDevice(int64_t{1} << 45, "the tile lists"); });  // 35 TB
  EXPECT_THAT(what, HasSubstr("35184.37 GB for the tile lists"));
  EXPECT_THAT(what, HasSubstr("--max-gaussians"));
  EXPECT_THAT(what, HasSubstr("GB free"));
  EXPECT_NO_THROW(CheckLaunch("the next kernel"));
  EXPECT_NO_THROW(FreeDevice(AllocateDevice(100, "a little")));
}

TEST_F(CudaMemory, NothingIsNull) {
  EXPECT_EQ(AllocateDevice(0, "nothing"), nullptr);
  EXPECT_EQ(AllocatePinned(0, "nothing"), nullptr);
  FreeDevice(nullptr);
  FreePinned(nullptr);
}

TEST_F(CudaMemory, IsReported) {
  const DeviceMemory memory = MemoryOfDevice();
  EXPECT_GT(memory.free, 0);
  EXPECT_LE(memory.free, memory.total);
}

TEST_F(CudaMemory, WhoKeepsSomeGivesItBackBeforeItEndsAndBeforeItIsCounted) {
  static int calls = 0;
  SetOutOfMemoryCallback([] { ++calls; });
  MemoryOfDevice();
  EXPECT_EQ(calls, 1);
  EXPECT_THROW(AllocateDevice(int64_t{1} << 45, "the tile lists"), OutOfMemory);
  EXPECT_EQ(calls, 2);
  FreeDevice(AllocateDevice(100, "a little"));
  EXPECT_EQ(calls, 2);
  SetOutOfMemoryCallback(nullptr);
}

TEST_F(CudaMemory, ADeviceThatIsNotThereIsRefused) {
  UseDevice(0);
  EXPECT_THAT(MessageOf<UsageError>([] { UseDevice(99); }), HasSubstr("--device cuda:99"));
  EXPECT_THROW(UseDevice(-1), UsageError);
}

#if defined(ORACLEGS_EMULATED_CUDA)
TEST(CudaDevices, NoneIsNoneAndAsOldDriverToo) {
  for (const cudaError_t status : {cudaErrorNoDevice, cudaErrorInsufficientDriver}) {
    emulated_cuda::SetDevices(status);
    EXPECT_EQ(DeviceCount(), 0);
    EXPECT_THROW(UseDevice(0), UsageError);
  }
  emulated_cuda::SetDevices(cudaSuccess);
  EXPECT_EQ(DeviceCount(), 1);
  EXPECT_NO_THROW(CheckLaunch("the next kernel"));
}

TEST(CudaMemoryEmulated, PinnedMemoryThatEndsIsToldToo) {
  EXPECT_THAT(MessageOf<RunError>([] { AllocatePinned(int64_t{1} << 60, "a number"); }), HasSubstr("pinned host"));
}
#endif

}  // namespace
}  // namespace oraclegs::cuda
