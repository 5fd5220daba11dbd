#pragma once
// Options of stereo as a run has them.

#include "oraclegs/core/options.h"
#include "oraclegs/depth/stereo.h"

namespace oraclegs {

struct AutoStereoOptions {
  int iterations = StereoOptions().iterations;
  Auto<int> geometric_passes;

  /// With the usual number of passes where nothing chose another one (run_size.h does for a run).
  StereoOptions Settled() const { return {iterations, geometric_passes.ValueOr(StereoOptions().geometric_passes)}; }

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("stereo-iterations", self.iterations,
          "Iterations of the photometric search (PatchMatch), at the coarse resolution", Range{1, 50}, Tier::kSetting);
    visit("stereo-passes", self.geometric_passes,
          "Geometric-consistency passes at each resolution; auto = 2, or 1 with --quality draft", Range{1, 16},
          Tier::kSetting);
  }
};

}  // namespace oraclegs
