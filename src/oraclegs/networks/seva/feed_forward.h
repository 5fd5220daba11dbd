#pragma once
// Feed-forward layer of SEVA's transformers: half of the first product's outputs gates the other half.

#include "oraclegs/networks/seva/sums.h"

namespace oraclegs::seva {

struct FeedForward {
  Linear in, out;
};
/// The hidden layer has 4 x `channels`.
FeedForward LoadFeedForward(const ParameterScope& at, int64_t channels);
/// x [..., channels] -> rows of the same shape: out(a * GELU(g)) with in(x) = (a, g), some tokens at a time. The bias
/// of `out` may be apart, as in AddendOf.
Addend Forward(const FeedForward& layer, const Tensor& x);

}  // namespace oraclegs::seva
