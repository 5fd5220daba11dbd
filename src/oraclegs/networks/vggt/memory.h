#pragma once
// How much memory VGGT needs, known before it starts.

#include "oraclegs/networks/vggt/vggt.h"

namespace oraclegs::vggt {

struct Pass {
  int64_t views = 1;
  int64_t height = 518, width = 518;  ///< of the network's input, pixels
  Heads heads = {};
};

/// Of the tensors that LoadVggt reads for these heads, as float32.
int64_t WeightBytes(const Config& config, const Heads& heads);

/// What a pass on a CPU in float32 holds beside the weights where it holds most; of VGGT-1B only the oracle pass was
/// measured, with a margin; the heads are counted (bench/networks/vggt_bench.cpp).
int64_t PassBytes(const Config& config, const Pass& pass);

}  // namespace oraclegs::vggt
