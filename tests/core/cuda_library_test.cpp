#include "oraclegs/core/cuda_library.h"

#include <gmock/gmock.h>

#include <cstdlib>

#include "oraclegs/core/buffer.h"
#include "oraclegs/core/error.h"
#include "support/errors.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;

TEST(CudaLibrary, IsNamedWhereItIsMissing) {
  setenv(kCudaVariable, "/nowhere/x.so", 1);
  EXPECT_FALSE(HasCudaLibrary());
  EXPECT_THAT(WhyNoCudaLibrary(), HasSubstr("/nowhere/x.so: there is no such file; install the package oraclegs-cuda"));
  EXPECT_THAT(MessageOf<UsageError>([] { Buffer<float>::Zeros({3}, {DeviceKind::kCuda, 0}); }), HasSubstr("x.so"));
  unsetenv(kCudaVariable);
}

}  // namespace
}  // namespace oraclegs
