#include "oraclegs/render/cuda/torch_memory.h"

#include <gmock/gmock.h>

#include "support/cuda_device.h"

namespace oraclegs::cuda {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class TorchMemoryTest : public CudaTest {};

TEST_F(TorchMemoryTest, HandsOnWhatTheWorkGives) {
  EXPECT_EQ(WithMemory("the rendered pictures", [] { return 3; }), 3);
}

TEST_F(TorchMemoryTest, TooLittleSaysForWhatAndWhatNeedsLess) {
  const auto work = [] { TORCH_CHECK(false, "CUDA out of memory. Tried to allocate 2.00 GiB\nmore lines"); };
  try {
    WithMemory("LPIPS of a proposal", work, "give --proposal-lpips 0");
    FAIL() << "must not pass";
  } catch (const OutOfMemory& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("out of GPU memory for LPIPS of a proposal"), HasSubstr("GB free"),
                                    HasSubstr("Tried to allocate 2.00 GiB)"), HasSubstr("; give --proposal-lpips 0"),
                                    testing::Not(HasSubstr("\n"))));
  }
}

TEST_F(TorchMemoryTest, OtherErrorsStayWhatTheyAre) {
  EXPECT_THROW(WithMemory("x", [] { TORCH_CHECK(false, "another error"); }), c10::Error);
}

}  // namespace
}  // namespace oraclegs::cuda
