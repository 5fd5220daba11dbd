#include "oraclegs/networks/cuda/kernels.h"

#include "networks/cuda/bfloat16.h"

namespace oraclegs::cuda {
namespace {

class GatedGeluTest : public CudaTest {};

double Gelu(double x) { return 0.5 * x * std::erfc(-x / std::sqrt(2.0)); }

TEST_F(GatedGeluTest, MultipliesValuesByTheGeluOfTheirGates) {
  for (const auto& [rows, width] : std::vector<std::pair<int, int>>{{1, 8}, {8, 8}, {21, 24}, {9, 1280}}) {
    const Halves both = RandomHalves({rows, 2 * width}, static_cast<uint64_t>(width));
    const Buffer<uint16_t> out = HalvesToFill({rows, width});
    RunGatedGelu({rows, width, both.bits(), out.data()}, kStream);
    Eigen::ArrayXd expected(rows * width);
    for (int r = 0; r < rows; ++r) {
      for (int c = 0; c < width; ++c) {
        const double value = both.values[2 * r * width + c], gate = both.values[(2 * r + 1) * width + c];
        expected[r * width + c] = value * Gelu(gate);
      }
    }
    EXPECT_LE(ErrorBeyondRounding(ValuesOf(out), expected, 1e-6), 0) << rows << " x " << width;
  }
}

TEST_F(GatedGeluTest, IsRightFarFromZero) {
  Buffer<float> both = Buffer<float>::Empty({1, 32});
  const std::vector<float> gates = {-100, -10, -6, -4, -3, -2, -1, -0.125f, 0, 0.125f, 1, 2, 4, 6, 10, 100};
  for (int64_t i = 0; i < 16; ++i) both.data()[i] = 1, both.data()[16 + i] = gates[static_cast<size_t>(i)];
  const Halves in = ToHalves(both);
  const Buffer<uint16_t> out = HalvesToFill({1, 16});
  RunGatedGelu({1, 16, in.bits(), out.data()}, kStream);
  Eigen::ArrayXd expected(16);
  for (int64_t i = 0; i < 16; ++i) expected[i] = Gelu(static_cast<double>(gates[static_cast<size_t>(i)]));
  EXPECT_LE(ErrorBeyondRounding(ValuesOf(out), expected, 1e-6), 0) << ValuesOf(out).transpose();
}

}  // namespace
}  // namespace oraclegs::cuda
