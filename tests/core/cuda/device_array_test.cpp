#include "oraclegs/core/cuda/device_array.h"

#include "oraclegs/core/error.h"
#include "support/cuda_device.h"

namespace oraclegs::cuda {
namespace {

class DeviceArrayTest : public CudaTest {};

TEST_F(DeviceArrayTest, StaysWhereItIsUntilItMustGrow) {
  DeviceArray<float> array("a test");
  EXPECT_EQ(array.data(), nullptr);
  array.Reserve(100);
  EXPECT_EQ(array.capacity(), 125);
  const float* first = array.data();
  array.Reserve(125);
  array.ReserveExactly(7);
  EXPECT_EQ(array.data(), first);
  array.ReserveExactly(200);
  EXPECT_EQ(array.bytes(), 800);
}

TEST_F(DeviceArrayTest, BringsBackWhatWasSent) {
  const std::vector<int> values = {3, 1, 4, 1, 5};
  DeviceArray<int> array("a test");
  array.Upload(values.data(), 5);
  EXPECT_EQ(ToHost(array, 5), values);
  array.FillBytes(0, 2, nullptr);
  EXPECT_EQ(ToHost(array, 5), (std::vector<int>{0, 0, 4, 1, 5}));
}

TEST_F(DeviceArrayTest, TooMuchIsSaidAndLeavesItEmpty) {
  DeviceArray<double> array("a test");
  array.Reserve(10);
  EXPECT_THROW(array.Reserve(int64_t{1} << 42), RunError);
  EXPECT_EQ(array.capacity(), 0);
  EXPECT_EQ(array.data(), nullptr);
  array.Reserve(10);
  EXPECT_NE(array.data(), nullptr);
}

TEST_F(DeviceArrayTest, SwapsWithoutCopying) {
  DeviceArray<int> a("one"), b("two");
  const int value = 7;
  a.Upload(&value, 1);
  const int* at = a.data();
  swap(a, b);
  EXPECT_EQ(b.data(), at);
  EXPECT_EQ(a.capacity(), 0);
}

TEST_F(DeviceArrayTest, AReadbackHoldsTheValueOfItsMoment) {
  DeviceArray<int> array("a test");
  int value = 7;
  array.Upload(&value, 1);
  Readback<int> readback;
  readback.Ask(array.data(), nullptr);
  EXPECT_EQ(readback.Get(), 7);
}

TEST_F(DeviceArrayTest, EventsMeasureTime) {
  Event begin, end;
  begin.Record(nullptr);
  end.Record(nullptr);
  end.Wait();
  EXPECT_GE(end.MillisecondsSince(begin), 0);
}

}  // namespace
}  // namespace oraclegs::cuda
