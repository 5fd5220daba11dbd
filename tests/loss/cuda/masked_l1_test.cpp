#include "oraclegs/loss/cuda/masked_l1.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "oraclegs/loss/depth_losses.h"
#include "support/buffers.h"
#include "support/device_buffers.h"

namespace oraclegs::cuda {
namespace {

class CudaMaskedL1 : public CudaTest {};

TEST_F(CudaMaskedL1, IsTheCpus) {
  for (const int64_t width : {1, 53, 311}) {
    const Shape shape{17, width};
    const Buffer<float> rendered = RandomUniform(shape, 3), target = RandomUniform(shape, 4);
    target.Rows(0, 3).CopyFrom(rendered.Rows(0, 3));  // no direction where both are equal
    const Buffer<uint8_t> mask = Buffer<uint8_t>::Empty(shape);
    Flat(mask) = (Flat(RandomUniform(shape, 5)) * 255).cast<uint8_t>();
    const Buffer<float> weights = ToBuffer(shape, Flat(mask).cast<float>() / 255);
    Buffer<float> grad = Buffer<float>::Empty(shape);
    const double expected = MaskedL1(rendered, target, weights, 0.3, &grad);

    const Buffer<float> x = OnTestDevice(rendered), y = OnTestDevice(target);
    const Buffer<float> g = Buffer<float>::Empty(shape, TestDevice());
    const Buffer<uint8_t> m = OnTestDevice(mask);
    DeviceArray<double> sums("a test");
    sums.ReserveExactly(MaskedL1Blocks(x.count()));
    MaskedL1Input in;
    in.pixels = x.count();
    in.rendered = x.data();
    in.target = {y.data(), false};
    in.mask = {m.data(), true};
    in.scale = static_cast<float>(0.3 / static_cast<double>(in.pixels));
    in.sums = sums.data();
    in.grad = g.data();
    const auto expect = [&](double value) {
      RunMaskedL1(in, nullptr);
      double total = 0;
      for (const double sum : ToHost(sums, MaskedL1Blocks(in.pixels))) total += sum;
      EXPECT_NEAR(0.3 * total / static_cast<double>(in.pixels), value, 1e-9);
      EXPECT_TRUE(Equal(OnHost(g), grad));
    };
    expect(expected);
    in.mask = {};
    expect(MaskedL1(rendered, target, {}, 0.3, &grad));
  }
}

}  // namespace
}  // namespace oraclegs::cuda
