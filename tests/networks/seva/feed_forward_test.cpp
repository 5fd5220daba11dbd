#include "oraclegs/networks/seva/feed_forward.h"

#include "networks/fixtures.h"
#include "oraclegs/networks/common/autocast.h"

namespace oraclegs::seva {
namespace {

FeedForward Layer() {
  RandomParameters source(4);
  return LoadFeedForward(ParameterScope(source), 256);
}
Tensor Noise(int64_t tokens) { return at::sin(at::arange(tokens * 256) * 0.7).view({1, tokens, 256}); }

TEST(SevaFeedForward, HalfOfTheProductGatesTheOther) {
  const FeedForward layer = Layer();
  const Tensor x = Noise(5), both = at::linear(x, layer.in.weight, layer.in.bias);
  const Tensor expected =
      at::linear(both.slice(2, 0, 1024) * at::gelu(both.slice(2, 1024, 2048)), layer.out.weight, layer.out.bias);
  const Addend out = Forward(layer, x);
  EXPECT_EQ(out.rows.sizes(), x.sizes());
  EXPECT_LE(MaxAbsError(out.rows, expected), 1e-5);
  EXPECT_FALSE(out.vectors.defined());
}

TEST(SevaFeedForward, SlicesDoNotChangeIt) {
  const FeedForward layer = Layer();
  const Tensor x = Noise(5000);  // 2048 numbers a token: slices of 2048 tokens
  const Tensor all = Forward(layer, x).rows;
  for (const int64_t t : {0, 2047, 2048, 4999}) {
    EXPECT_LE(MaxAbsError(all.slice(1, t, t + 1), Forward(layer, x.slice(1, t, t + 1)).rows), 1e-5) << t;
  }
}

TEST(SevaFeedForward, WithinAutocastRowsHaveItsType) {
  const FeedForward layer = Layer();
  const Tensor x = Noise(3000), exact = Forward(layer, x).rows;
  const Autocast scope(torch::kCPU, torch::kBFloat16);
  const Tensor rows = Forward(layer, x).rows;
  EXPECT_EQ(rows.scalar_type(), torch::kBFloat16);
  EXPECT_LE(RelativeL2(rows, exact), 0.02);
}

}  // namespace
}  // namespace oraclegs::seva
