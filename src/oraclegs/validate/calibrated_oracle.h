#pragma once
// The oracle of a run: calibrated on held-out views, for candidates and for what is mixed from them.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "oraclegs/propose/proposers.h"
#include "oraclegs/validate/consistency.h"
#include "oraclegs/validate/options.h"
#include "oraclegs/validate/pick.h"
#include "oraclegs/validate/tamper_trained_oracle.h"

namespace oraclegs {

/// Number of images that VGGT is to look at together.
struct ChunkRequest {
  Auto<int> asked;   ///< 0 = all
  size_t usual = 0;  ///< where it is automatic
  size_t all = 0;
};

/// How many images VGGT looks at together: the number asked for; or the most whose pass needs no more than the free
/// memory, up to the usual number where that is automatic, up to all where 0 is asked for. bytes(n): what a pass over n
/// of them needs with the weights; available: bytes, 0 = unknown. Warns of a chunk that was made smaller, or that was
/// asked for and may not fit. Throws RunError when not even one fits and no number was asked for.
size_t ChooseChunk(const std::function<int64_t(int64_t)>& bytes, const ChunkRequest& request, uint64_t available,
                   const Listener& listener);

/// The oracle of a run, before it has learned.
struct OracleSetup {
  OracleKind kind = OracleKind::kConsistency;
  ValidateOptions options = {};
  std::filesystem::path vggt = {};  ///< weights, for the kinds that ask VGGT; empty = it is not asked
  Device device = kCpu;             ///< where VGGT computes
  VggtPrecision precision = VggtPrecision::kFloat32;
  uint64_t free_bytes = 0;      ///< free memory there; 0 = unknown
  bool unknown_errors = false;  ///< some proposals come from generators that cannot hold a view out
  size_t targets = 0;           ///< to be classified, for the progress of "validate"
  uint64_t seed = 0;
};

class CalibratedOracle {
 public:
  /// Learns from held-out views (but "uniform", and "vggt" without --set calibrate). `views`, the training views, and
  /// `proposers` must outlive it. Throws InputError for weights that do not fit, RunError when VGGT needs more memory
  /// than there is.
  CalibratedOracle(const OracleSetup& setup, const std::vector<LoadedView>& views, const Proposers& proposers,
                   const Listener& listener);
  ~CalibratedOracle();

  /// How many targets are best classified in one call.
  size_t together() const { return together_; }
  /// True when passes of VGGT are what the time goes to; they are reported as they are done.
  bool reports_progress() const { return second_ != nullptr; }

  /// One image and its confidence for each target that has candidates, in their order. Candidates that do not show the
  /// scene from their pose are left out where there are others.
  std::vector<Validated> Classify(std::vector<std::vector<Proposal>> candidates) const;

 private:
  struct Progress;

  const Oracle& oracle() const;
  void LoadSecond(const OracleSetup& setup, const std::vector<LoadedView>& views, const Listener& listener);
  void Calibrate(const HeldOutCandidates& held_out);
  /// Confidence of each proposal, from the tamper-trained oracle where `unknown`.
  std::vector<ConfidenceMap> Predict(const std::vector<Proposal>& proposals, const std::vector<bool>& unknown) const;

  PickRule rule_;
  size_t together_;
  std::shared_ptr<Progress> progress_;             ///< passes of second_
  std::unique_ptr<Oracle> second_;                 ///< VGGT before calibration, null without
  std::unique_ptr<ConsistencyOracle> calibrated_;  ///< null where VGGT's maps are used as they are
  std::unique_ptr<Oracle> uniform_;
  std::unique_ptr<TamperTrainedOracle> tamper_trained_;  ///< null without generators that cannot hold a view out
  std::set<std::string> calibrated_sources_;             ///< sources that can
};

}  // namespace oraclegs
