#include "oraclegs/loss/cuda/depth.h"

#include "oraclegs/loss/depth.h"
#include "support/device_tensors.h"
#include "support/golden.h"
#include "support/tensors.h"

namespace oraclegs::cuda {
namespace {

class CudaDepthLoss : public CudaTest {};

TEST_F(CudaDepthLoss, IsTheCpus) {
  torch::manual_seed(3);
  for (const int64_t width : {1, 53, 311}) {
    const Tensor inv_depth = torch::rand({17, width}), mask = (torch::rand({17, width}) * 255).to(torch::kByte);
    Tensor target = torch::rand({17, width});
    target.narrow(0, 0, 3).copy_(inv_depth.narrow(0, 0, 3));  // no direction where both are equal
    const Tensor weights = mask.to(torch::kFloat) / 255;
    Tensor grad = torch::empty_like(inv_depth);
    const double expected = DepthLoss(inv_depth, target, weights, 0.3, &grad);

    const Tensor x = OnTestDevice(inv_depth), y = OnTestDevice(target), m = OnTestDevice(mask),
                 g = torch::empty_like(x);
    DeviceArray<double> sums("a test");
    sums.ReserveExactly(DepthBlocks(x.numel()));
    DepthInput in;
    in.pixels = x.numel();
    in.inv_depth = x.data_ptr<float>();
    in.target = y.data_ptr<float>();
    in.mask = {m.data_ptr(), true};
    in.scale = static_cast<float>(0.3 / static_cast<double>(in.pixels));
    in.sums = sums.data();
    in.grad = g.data_ptr<float>();
    RunDepth(in, nullptr);
    double total = 0;
    for (const double sum : ToHost(sums, DepthBlocks(in.pixels))) total += sum;
    EXPECT_NEAR(0.3 * total / static_cast<double>(in.pixels), expected, 1e-9);
    EXPECT_TRUE(torch::equal(OnHost(g), grad));
  }
}

}  // namespace
}  // namespace oraclegs::cuda
