#pragma once
// The paper's oracle: what the views of a scene look at in each other inside VGGT (spec/vggt.md 8).

#include <functional>
#include <vector>

#include "oraclegs/networks/vggt/attention_confidence.h"
#include "oraclegs/scene/loaded_view.h"
#include "oraclegs/validate/oracle.h"

namespace oraclegs {

struct VggtOracleOptions {
  AttentionMode mode = AttentionMode::kReference;
  size_t chunk = 8;    ///< proposals in one pass, beside the photograph
  int64_t side = 518;  ///< longer side of the network's input, pixels
  std::vector<int64_t> layers = {0, 22};
  std::vector<double> weights = {0.25, 0.75};  ///< of the layers
  /// Told after each pass how many proposals it looked at; may be empty.
  std::function<void(size_t)> looked = {};
};

/// Passes of a photograph and a few proposals (view_chunks.h) through the aggregator. A map is large where the other
/// views, or the photograph, look at the proposal: it orders pixels, and is no probability until it is calibrated
/// (ConsistencyOracle). Proposals of one pass judge each other; those of other passes do not matter.
class VggtOracle : public Oracle {
 public:
  /// `photos` must outlive it. Throws ShapeError when layers and weights differ in number or the chunk is 0.
  VggtOracle(Aggregator aggregator, VggtOracleOptions options, const std::vector<LoadedView>& photos);

  std::string name() const override { return "vggt"; }
  /// Throws InputError as PlanChunks does, and Interrupted.
  std::vector<ConfidenceMap> Judge(const std::vector<HiddenPhotograph>& hidden) const override;

 private:
  /// [members, proposal's height, proposal's width] float32 in [0, 1].
  Tensor Look(const Image8& photograph, const std::vector<Image8>& proposals) const;

  Aggregator aggregator_;
  VggtOracleOptions options_;
  const std::vector<LoadedView>& photos_;
};

}  // namespace oraclegs
