#pragma once
// Memory that VGGT needs, known before it starts.

#include "oraclegs/networks/vggt/vggt.h"

namespace oraclegs::vggt {

struct Pass {
  int64_t views = 1;
  int64_t height = 518, width = 518;  ///< size of the network's input, pixels
  Heads heads = {};
};

/// Bytes of the tensors that LoadVggt reads for these heads, as float32.
int64_t WeightBytes(const Config& config, const Heads& heads);

/// Peak bytes of a pass on a CPU in float32, beside the weights. For VGGT-1B the pass of the oracle was measured and
/// has a margin; the heads are counted (bench/networks/vggt_bench.cpp).
int64_t PassBytes(const Config& config, const Pass& pass);

}  // namespace oraclegs::vggt
