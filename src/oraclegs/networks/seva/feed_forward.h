#pragma once
// The feed-forward layer of SEVA's transformers: half of what its first product gives gates the other half.

#include "oraclegs/networks/seva/sums.h"

namespace oraclegs::seva {

struct FeedForward {
  Linear in, out;
};
/// Four times as wide inside as `channels`.
FeedForward LoadFeedForward(const ParameterScope& at, int64_t channels);
/// x [..., channels] -> rows of the same shape: out(a * GELU(g)) with in(x) = (a, g), some tokens at a time. As of
/// AddendOf, the bias of `out` may stand apart.
Addend Forward(const FeedForward& layer, const Tensor& x);

}  // namespace oraclegs::seva
