#pragma once
// The oracle that needs no weights: what the photographs show at a proposal's pixels, and what such pixels turned out
// to be worth where a photograph was hidden and proposed (spec/weight_free.md, "Confidence U").

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "oraclegs/propose/warp.h"
#include "oraclegs/validate/features.h"
#include "oraclegs/validate/isotonic.h"
#include "oraclegs/validate/logistic.h"
#include "oraclegs/validate/oracle.h"

namespace oraclegs {

/// How good a colour is that is off by `error` (RMS over the channels): exp(-(error / 0.08)^2).
float Goodness(float error);

/// What is known of a pixel before it is decided how far to trust it.
enum class Evidence {
  kPhotographs,  ///< the features of validate/features.h
  kSecond,       ///< what a second oracle says, alone
  kBoth,
};

/// Confidence = the goodness that pixels with such features had where photographs were hidden: by logistic regression
/// for the order of the pixels, smoothed where it comes from the photographs (smooth.h), and an isotonic map for its
/// level, one of each for every proposer. Never looks at a test view. What is referenced must outlive it.
class ConsistencyOracle : public Oracle {
 public:
  ConsistencyOracle(const Warper& warper, const std::vector<LoadedView>& photos) : warper_(warper), photos_(photos) {}
  /// Calibrates another oracle, alone or beside the photographs: its maps are one more feature.
  ConsistencyOracle(const Warper& warper, const std::vector<LoadedView>& photos, const Oracle& second, Evidence evidence)
      : warper_(warper), photos_(photos), evidence_(evidence), second_(&second) {}

  /// The level stays as the regression has it. To be called before Learn.
  void LeaveLevel() { finds_level_ = false; }

  /// Asks the second oracle about each, once for Learn and Judge, which ask again where nobody did. Nothing to do
  /// without one.
  void Look(std::vector<HiddenPhotograph>* hidden) const;

  /// Learns from hidden photographs; those of a source that was learnt before replace it. Warps each. Throws InputError
  /// when no pixel of them counts.
  void Learn(const std::vector<HiddenPhotograph>& hidden);

  /// "consistency", the second oracle's name, or that + "+consistency".
  std::string name() const override;
  /// A source that was not learnt (a folder) is judged as what Learn was first given, all together. Throws UsageError
  /// before anything was learnt.
  std::vector<ConfidenceMap> Judge(const std::vector<HiddenPhotograph>& hidden) const override;

 private:
  struct Model {
    Logistic order;
    Isotonic level;
  };
  struct Samples;
  Model Fit(const Samples& samples) const;

  bool ReadsPhotographs() const { return evidence_ != Evidence::kSecond; }
  std::vector<Features> FeaturesAt(const HiddenPhotograph& hidden, const WarpedView& warped) const;
  std::vector<ConfidenceMap> SecondMaps(const std::vector<HiddenPhotograph>& hidden) const;
  template <class Take>
  void ForEach(const std::vector<HiddenPhotograph>& hidden, const Take& take) const;

  const Warper& warper_;
  const std::vector<LoadedView>& photos_;
  Evidence evidence_ = Evidence::kPhotographs;
  const Oracle* second_ = nullptr;
  bool finds_level_ = true;
  std::map<std::string, Model> by_source_;
  std::optional<Model> any_;
};

}  // namespace oraclegs
