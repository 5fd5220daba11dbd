#include "oraclegs/core/cuda/check.h"

#include <gmock/gmock.h>

#include "oraclegs/core/error.h"
#include "support/cuda_device.h"
#include "support/errors.h"
#if defined(ORACLEGS_EMULATED_CUDA)
#include "support/emulated_cuda/runtime.h"
#endif

namespace oraclegs::cuda {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(CudaCheck, SuccessIsSilent) { EXPECT_NO_THROW(Check(cudaSuccess, "nothing")); }

TEST(CudaCheck, AMissingDeviceIsTheUsersToMend) {
  const std::string what = MessageOf<UsageError>([] { Check(cudaErrorNoDevice, "looking for a GPU"); });
  EXPECT_THAT(what, HasSubstr("looking for a GPU"));
  EXPECT_THAT(what, HasSubstr("--device cpu"));
}

TEST(CudaCheck, AnOldDriverIsTold) {
  EXPECT_THAT(MessageOf<UsageError>([] { Check(cudaErrorInsufficientDriver, "x"); }),
              AllOf(HasSubstr("has no NVIDIA driver, or one older"), HasSubstr("install or update the driver")));
}

TEST(CudaCheck, ABuildForAnotherGpuIsTold) {
  EXPECT_THAT(MessageOf<UsageError>([] { Check(cudaErrorNoKernelImageForDevice, "x"); }),
              HasSubstr("CMAKE_CUDA_ARCHITECTURES"));
}

TEST(CudaCheck, OtherErrorsNameTheWorkAndCudasWords) {
  const std::string what = MessageOf<RunError>([] { Check(cudaErrorIllegalAddress, "blending"); });
  EXPECT_THAT(what, HasSubstr("blending"));
  EXPECT_THAT(what, HasSubstr("cudaErrorIllegalAddress"));
}

#if defined(ORACLEGS_EMULATED_CUDA)
TEST(CudaLaunch, AFailedKernelIsNamed) {
  emulated_cuda::SetLastError(cudaErrorIllegalAddress);
  EXPECT_THAT(MessageOf<RunError>([] { CheckLaunch("blend forward"); }), HasSubstr("blend forward"));
  EXPECT_NO_THROW(CheckLaunch("the next kernel"));
}
#endif

}  // namespace
}  // namespace oraclegs::cuda
