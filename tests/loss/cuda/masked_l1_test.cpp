#include "oraclegs/loss/cuda/masked_l1.h"

#include "oraclegs/loss/masked_l1.h"
#include "support/device_tensors.h"
#include "support/golden.h"
#include "support/tensors.h"

namespace oraclegs::cuda {
namespace {

class CudaMaskedL1 : public CudaTest {};

TEST_F(CudaMaskedL1, IsTheCpus) {
  torch::manual_seed(3);
  for (const int64_t width : {1, 53, 311}) {
    const Tensor rendered = torch::rand({17, width}), mask = (torch::rand({17, width}) * 255).to(torch::kByte);
    Tensor target = torch::rand({17, width});
    target.narrow(0, 0, 3).copy_(rendered.narrow(0, 0, 3));  // no direction where both are equal
    const Tensor weights = mask.to(torch::kFloat) / 255;
    Tensor grad = torch::empty_like(rendered);
    const double expected = MaskedL1(rendered, target, weights, 0.3, &grad);

    const Tensor x = OnTestDevice(rendered), y = OnTestDevice(target), m = OnTestDevice(mask), g = torch::empty_like(x);
    DeviceArray<double> sums("a test");
    sums.ReserveExactly(MaskedL1Blocks(x.numel()));
    MaskedL1Input in;
    in.pixels = x.numel();
    in.rendered = x.data_ptr<float>();
    in.target = y.data_ptr<float>();
    in.mask = {m.data_ptr(), true};
    in.scale = static_cast<float>(0.3 / static_cast<double>(in.pixels));
    in.sums = sums.data();
    in.grad = g.data_ptr<float>();
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
