#include "oraclegs/train/cuda/loss_accumulator.h"

#include <limits>

#include "support/cuda_device.h"

namespace oraclegs::cuda {
namespace {

class CudaLossAccumulator : public CudaTest {
 protected:
  DeviceArray<double> values{"a test"};
  DeviceArray<LossAccumulator> accumulator{"a test"};

  LossAccumulator Add(int64_t iteration, double constant) {
    LossAccumulatorInput in;
    in.loss.Add({values.data(), 500, 2, 0.5});
    in.loss.Add({values.data() + 1, 500, 2, 2});
    in.loss.constant = constant;
    in.iteration = iteration;
    in.smoothing = 0.9;
    in.accumulator = accumulator.data();
    RunAccumulateLoss(in, nullptr);
    return ToHost(accumulator, 1)[0];
  }

  void SetUp() override {
    CudaTest::SetUp();
    if (IsSkipped()) return;
    std::vector<double> numbers(1000);
    for (size_t i = 0; i < numbers.size(); ++i) numbers[i] = i % 2 ? 0.25 : 1;
    values.Upload(numbers.data(), 1000);
    const LossAccumulator empty;
    accumulator.Upload(&empty, 1);
  }
};

TEST_F(CudaLossAccumulator, AddsUpAndSmooths) {
  const LossAccumulator first = Add(1, 3);
  EXPECT_EQ(first.last, 250 + 250 + 3);
  EXPECT_EQ(first.smoothed, first.last);
  const LossAccumulator second = Add(2, 13);
  EXPECT_EQ(second.last, 513);
  EXPECT_NEAR(second.smoothed, 0.9 * 503 + 0.1 * 513, 1e-9);
  EXPECT_EQ(second.nonfinite_iteration, 0);
}

TEST_F(CudaLossAccumulator, RemembersTheFirstLossThatIsNotFinite) {
  Add(1, 0);
  Add(2, std::numeric_limits<double>::infinity());
  Add(3, std::numeric_limits<double>::quiet_NaN());
  const LossAccumulator last = Add(4, 0);
  EXPECT_EQ(last.nonfinite_iteration, 2);
  EXPECT_EQ(last.nonfinite_loss, std::numeric_limits<double>::infinity());
  EXPECT_EQ(last.last, 500);
}

}  // namespace
}  // namespace oraclegs::cuda
