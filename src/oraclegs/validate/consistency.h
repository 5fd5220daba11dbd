#pragma once
// The oracle that needs no weights: what the photographs show at a proposal's pixels, and what such pixels turned out
// to be worth where a photograph was hidden and proposed (spec/weight_free.md, "Confidence U").

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "oraclegs/propose/warp.h"
#include "oraclegs/validate/isotonic.h"
#include "oraclegs/validate/logistic.h"
#include "oraclegs/validate/oracle.h"

namespace oraclegs {

/// How good a colour is that is off by `error` (RMS over the channels): exp(-(error / 0.08)^2).
float Goodness(float error);

/// A photograph that was hidden, and what a proposer said stood there.
struct HiddenPhotograph {
  int photograph = 0;  ///< index
  Proposal proposal;
};

/// Confidence = the goodness that pixels with such features had where photographs were hidden: by logistic regression
/// for the order of the pixels and an isotonic map for its level, one of each for every proposer. Never looks at a test
/// view. `warper` and `photos` must outlive it.
class ConsistencyOracle : public Oracle {
 public:
  ConsistencyOracle(const Warper& warper, const std::vector<Photo>& photos) : warper_(warper), photos_(photos) {}

  /// Learns from hidden photographs; those of a source that was learnt before replace it. Warps each. Throws InputError
  /// when no pixel of them counts.
  void Learn(const std::vector<HiddenPhotograph>& hidden);

  std::string name() const override { return "consistency"; }
  /// A source that was not learnt (a folder) is judged as what Learn was first given, all together. Throws UsageError
  /// before anything was learnt.
  std::vector<ConfidenceMap> Validate(const std::vector<Proposal>& proposals) const override;
  /// The same of proposals made without a photograph.
  std::vector<ConfidenceMap> Judge(const std::vector<HiddenPhotograph>& hidden) const;

 private:
  struct Model {
    Logistic order;
    Isotonic level;
  };
  struct Samples;
  static Model Fit(const Samples& samples);

  const Warper& warper_;
  const std::vector<Photo>& photos_;
  std::map<std::string, Model> by_source_;
  std::optional<Model> any_;
};

}  // namespace oraclegs
