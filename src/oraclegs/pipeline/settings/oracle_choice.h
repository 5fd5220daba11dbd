#pragma once
// Which oracle a run uses, with nothing left to choose.

#include <functional>
#include <optional>
#include <string>

#include "oraclegs/pipeline/run.h"
#include "oraclegs/pipeline/settings/vggt_weights.h"

namespace oraclegs {

struct OracleChoice {
  std::string oracle;                  ///< a word of --oracle, never "auto"
  std::optional<VggtWeights> weights;  ///< of "vggt" and "vggt+consistency"

  /// Tells one choice from another, for the key of a stage.
  std::string Key() const { return oracle + (weights ? " " + weights->fingerprint : ""); }
};

/// Throws InputError as RequireVggtWeights does.
OracleChoice ChooseOracle(const RunOptions& options);

/// Says what `auto` came to.
void TellOracle(const RunOptions& options, const OracleChoice& choice, const Listener& listener);

/// How many proposals VGGT looks at together: `asked`, or where that is 0 the most, up to 8, whose pass needs no more
/// than the free memory. bytes(n): what a pass over n proposals needs with the weights; available: bytes, 0 = nobody
/// knows. A chunk made smaller, or one that was asked for and may not fit, is told with a warning. Throws RunError when
/// not even one fits and none was asked for.
size_t ChooseChunk(const std::function<int64_t(int64_t)>& bytes, int64_t asked, uint64_t available,
                   const Listener& listener);

}  // namespace oraclegs
