#include "oraclegs/loss/cuda/masked_l1.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "oraclegs/loss/masked_l1.h"
#include "support/device_buffers.h"
#include "support/buffers.h"

namespace oraclegs::cuda {
namespace {

class CudaMaskedL1 : public CudaTest {};

TEST_F(CudaMaskedL1, IsTheCpus) {
  torch::manual_seed(3);
  for (const int64_t width : {1, 53, 311}) {
    const Buffer<float> rendered = torch::rand({17, width}), mask = (torch::rand({17, width}) * 255).to(torch::kByte);
    Buffer<float> target = torch::rand({17, width});
    target.narrow(0, 0, 3).copy_(rendered.narrow(0, 0, 3));  // no direction where both are equal
    const Buffer<float> weights = mask.to(torch::kFloat) / 255;
    Buffer<float> grad = Buffer<float>::Empty(rendered.shape());
    const double expected = MaskedL1(rendered, target, weights, 0.3, &grad);

    const Buffer<float> x = OnTestDevice(rendered), y = OnTestDevice(target), m = OnTestDevice(mask), g = Buffer<float>::Empty(x.shape());
    DeviceArray<double> sums("a test");
    sums.ReserveExactly(MaskedL1Blocks(x.count()));
    MaskedL1Input in;
    in.pixels = x.count();
    in.rendered = x.data();
    in.target = y.data();
    in.mask = {m.data_ptr(), true};
    in.scale = static_cast<float>(0.3 / static_cast<double>(in.pixels));
    in.sums = sums.data();
    in.grad = g.data();
    const auto expect = [&](double value) {
      RunMaskedL1(in, nullptr);
      double total = 0;
      for (const double sum : ToHost(sums, MaskedL1Blocks(in.pixels))) total += sum;
      EXPECT_NEAR(0.3 * total / static_cast<double>(in.pixels), value, 1e-9);
      EXPECT_TRUE(torch::equal(OnHost(g), grad));
    };
    expect(expected);
    in.mask = {};
    expect(MaskedL1(rendered, target, {}, 0.3, &grad));
  }
}

}  // namespace
}  // namespace oraclegs::cuda
