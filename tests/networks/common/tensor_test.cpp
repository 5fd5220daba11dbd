#include "oraclegs/networks/common/tensor.h"

#include <gtest/gtest.h>
#include <torch/cuda.h>

#include <numeric>

namespace oraclegs {
namespace {

TEST(TensorOf, SharesTheBuffersMemory) {
  const Buffer<float> buffer = Buffer<float>::From({2, 3}, {0, 1, 2, 3, 4, 5});
  const Tensor tensor = TensorOf(buffer);
  EXPECT_EQ(tensor.data_ptr<float>(), buffer.data());
  EXPECT_EQ(tensor.sizes(), (std::vector<int64_t>{2, 3}));
  EXPECT_EQ(tensor.scalar_type(), torch::kFloat);
  tensor.add_(1);
  EXPECT_EQ(buffer[5], 6);
  EXPECT_FALSE(TensorOf({}).defined());
  EXPECT_EQ(TensorOf(buffer.Rows(1, 2)).data_ptr<float>(), buffer.data() + 3);
}

TEST(TensorOf, KeepsTheMemoryAsLongAsItLives) {
  Tensor tensor;
  std::weak_ptr<Storage> storage;
  {
    const Buffer<float> buffer = Buffer<float>::Full({4}, 7);
    storage = buffer.storage();
    tensor = TensorOf(buffer).slice(0, 1);
  }
  EXPECT_FALSE(storage.expired());
  EXPECT_EQ(tensor[2].item<float>(), 7);
  tensor = Tensor();
  EXPECT_TRUE(storage.expired());
}

TEST(BufferOf, SharesTheTensorsMemory) {
  Buffer<float> buffer;
  {
    const Tensor tensor = torch::arange(6, torch::kFloat).view({3, 2});
    buffer = BufferOf(tensor);
    EXPECT_EQ(buffer.data(), tensor.data_ptr<float>());
  }
  EXPECT_EQ(buffer.shape(), (Shape{3, 2}));
  EXPECT_EQ(buffer.device(), kCpu);
  EXPECT_EQ(std::accumulate(buffer.span().begin(), buffer.span().end(), 0.f), 15);
  EXPECT_FALSE(BufferOf({}).defined());
}

TEST(BufferOf, CopiesWhatIsNotContiguousAndRefusesOtherTypes) {
  const Tensor tensor = torch::arange(6, torch::kFloat).view({3, 2});
  const Buffer<float> turned = BufferOf(tensor.t());
  EXPECT_EQ(turned.shape(), (Shape{2, 3}));
  EXPECT_EQ(turned[1], 2);
  EXPECT_THROW(BufferOf(tensor.to(torch::kDouble)), ShapeError);
}

TEST(TensorBuffer, RoundTripGivesBackTheSameMemory) {
  const Buffer<float> buffer = Buffer<float>::Full({5}, 1);
  EXPECT_EQ(BufferOf(TensorOf(buffer)).data(), buffer.data());
}

TEST(ToTorch, NamesTheSameDevice) {
  EXPECT_EQ(ToTorch(kCpu), torch::Device(torch::kCPU));
  EXPECT_EQ(ToTorch({DeviceKind::kCuda, 1}), torch::Device(torch::kCUDA, 1));
  EXPECT_EQ(FromTorch(torch::Device(torch::kCUDA, 1)), (Device{DeviceKind::kCuda, 1}));
  EXPECT_EQ(FromTorch(torch::Device(torch::kCPU)), kCpu);
  EXPECT_THROW(FromTorch(torch::Device(torch::kMeta)), ShapeError);
}

TEST(TensorBuffer, SharesMemoryOfAGpu) {
  if (!torch::cuda::is_available()) GTEST_SKIP() << "libtorch finds no GPU";
  const Tensor tensor = torch::arange(6, torch::TensorOptions(torch::kFloat).device(torch::kCUDA));
  const Buffer<float> buffer = BufferOf(tensor);
  EXPECT_TRUE(buffer.device().is_cuda());
  EXPECT_EQ(TensorOf(buffer).data_ptr<float>(), tensor.data_ptr<float>());
  TensorOf(buffer).add_(1);
  EXPECT_EQ(tensor[5].item<float>(), 6);
}

}  // namespace
}  // namespace oraclegs
