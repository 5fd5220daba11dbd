#include "oraclegs/networks/cuda/kernels.h"

#include "networks/cuda/bfloat16.h"

namespace oraclegs::cuda {
namespace {

struct Rows {
  int rows, width, rows_a_vector;
};

class AddNormTest : public OnDevice<testing::TestWithParam<Rows>> {
 protected:
  void SetUp() override {
    OnDevice::SetUp();
    if (IsSkipped()) return;
    const auto [rows, width, rows_a_vector] = GetParam();
    x = RandomHalves({rows, width}, 1);
    added = RandomHalves({rows, width}, 2);
    vectors = RandomHalves({rows / rows_a_vector, width}, 3);
    weight = RandomHalves({width}, 4);
    bias = RandomHalves({width}, 5);
    sum = HalvesToFill({rows, width});
    normed = HalvesToFill({rows, width});
    in.rows = rows, in.width = width;
    in.x = x.bits();
    in.rows_a_vector = rows_a_vector;
    in.weight = weight.bits(), in.bias = bias.bits(), in.eps = 1e-5f;
    in.sum = sum.data(), in.normed = normed.data();
  }
  Eigen::ArrayXd ExpectedSum() const {
    Eigen::ArrayXd out = x.values;
    for (int64_t i = 0; i < out.size(); ++i) {
      if (in.added != nullptr) out[i] += added.values[i];
      if (in.vectors != nullptr) out[i] += vectors.values[i / in.width / in.rows_a_vector * in.width + i % in.width];
    }
    return out;
  }
  Eigen::ArrayXd Normed(const Eigen::ArrayXd& all) const {
    Eigen::ArrayXd out(all.size());
    for (int64_t r = 0; r < in.rows; ++r) {
      const Eigen::ArrayXd row = all.segment(r * in.width, in.width), away = row - row.mean();
      out.segment(r * in.width, in.width) =
          away / std::sqrt(away.square().mean() + static_cast<double>(in.eps)) * weight.values + bias.values;
    }
    return out;
  }

  Halves x, added, vectors, weight, bias;
  Buffer<uint16_t> sum, normed;
  AddNorm in;
};

TEST_P(AddNormTest, SumsAndNormalizes) {
  in.added = added.bits(), in.vectors = vectors.bits();
  RunAddNorm(in, kStream);
  EXPECT_LE(ErrorBeyondRounding(ValuesOf(sum), ExpectedSum(), 0), 1e-6);
  EXPECT_LE(ErrorBeyondRounding(ValuesOf(normed), Normed(ExpectedSum()), 1e-5), 0);
}

TEST_P(AddNormTest, EachPartMayBeAbsent) {
  for (const bool has_added : {false, true}) {
    for (const bool has_vectors : {false, true}) {
      in.added = has_added ? added.bits() : nullptr;
      in.vectors = has_vectors ? vectors.bits() : nullptr;
      RunAddNorm(in, kStream);
      EXPECT_LE(ErrorBeyondRounding(ValuesOf(sum), ExpectedSum(), 0), 1e-6);
      EXPECT_LE(ErrorBeyondRounding(ValuesOf(normed), Normed(ExpectedSum()), 1e-5), 0);
    }
  }
  in.vectors = nullptr;
  in.sum = nullptr;
  RunAddNorm(in, kStream);
  EXPECT_LE(ErrorBeyondRounding(ValuesOf(normed), Normed(ExpectedSum()), 1e-5), 0);
  in.normed = nullptr, in.weight = nullptr, in.bias = nullptr;
  sum = HalvesToFill({in.rows, in.width});
  in.sum = sum.data();
  RunAddNorm(in, kStream);
  EXPECT_LE(ErrorBeyondRounding(ValuesOf(sum), ExpectedSum(), 0), 1e-6);
}

TEST_P(AddNormTest, SumMayReplaceX) {
  in.added = added.bits();
  in.sum = x.device.data();
  RunAddNorm(in, kStream);
  EXPECT_LE(ErrorBeyondRounding(ValuesOf(x.device), ExpectedSum(), 0), 1e-6);
  EXPECT_LE(ErrorBeyondRounding(ValuesOf(normed), Normed(ExpectedSum()), 1e-5), 0);
}

INSTANTIATE_TEST_SUITE_P(Shapes, AddNormTest,
                         testing::Values(Rows{1, 2, 1}, Rows{64, 320, 64}, Rows{45, 640, 15}, Rows{33, 1280, 1},
                                         Rows{7, 962, 7}));

}  // namespace
}  // namespace oraclegs::cuda
