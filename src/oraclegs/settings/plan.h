#pragma once
// Plan of a run: everything automatic is settled here, once, from the options and from the files on this machine; its
// size is in run_size.h, what waits for results of the run in from_results.h.

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "oraclegs/core/buffer.h"
#include "oraclegs/core/progress.h"
#include "oraclegs/settings/device.h"
#include "oraclegs/settings/options.h"
#include "oraclegs/settings/vggt_weights.h"
#include "oraclegs/settings/weights.h"

namespace oraclegs {

/// True when the run makes proposals itself.
bool ProposesViews(const RunOptions& options);
/// True when there are proposals: the run's own, or those of a folder.
bool HasProposals(const RunOptions& options);
/// True when a stage after "sfm" needs depth: a dense start, depth in the loss, or proposals. False for --depth-prior
/// none.
bool NeedsDepth(const RunOptions& options);

/// Oracle that classifies the proposals.
struct OracleChoice {
  OracleKind kind = OracleKind::kConsistency;
  std::optional<VggtWeights> weights = {};  ///< set for the kinds that use VGGT
  std::string why_no_vggt = {};             ///< why VGGT is left alone though its weights are here; "" = it is not

  /// Text that identifies the choice in the key of a stage.
  std::string Key() const { return Word(kind) + (weights ? " " + weights->fingerprint : ""); }
};

/// Throws InputError as RequireVggtWeights does, UsageError for --set vggt-layers that the network does not have.
OracleChoice ChooseOracle(const RunOptions& options);

/// --set vggt-precision, where VGGT computes on this device.
VggtPrecision SettlePrecision(const ValidateOptions& asked, Device device);

/// Notes the choice for --oracle auto where VGGT's weights are.
void ReportOracleChoice(const RunOptions& options, const OracleChoice& choice, const Listener& listener);

struct Plan {
  DeviceSupport support;
  ImageOptions image = {};                   ///< size of the photos; set once the size of the run is settled
  Device device;                             ///< device of training, rendering and networks
  bool needs_depth = false;                  ///< stage "depth" runs
  bool proposes = false;                     ///< the run makes proposals itself
  bool has_proposals = false;                ///< the run proposes, or a folder has proposals
  DepthSource depth = {};                    ///< valid when needs_depth
  bool refines_poses = false;                ///< stage "poses" runs: it corrects poses where that is needed
  OracleChoice oracle = {};                  ///< valid when has_proposals
  std::optional<VggtWeights> poses = {};     ///< set for --poses vggt when poses are to be found; unset = colmap
  std::filesystem::path keypoints = {};      ///< weights of ALIKED, for colmap's poses; empty = SIFT alone
  std::vector<std::filesystem::path> lpips;  ///< weight files; empty = no LPIPS

  /// True when the run makes proposals itself, and asks the proposer of this word.
  bool Uses(const RunOptions& options, std::string_view proposer) const {
    return proposes && options.propose.Uses(proposer);
  }
};

/// Whether stage "poses" runs, in a plan that has its source of depth. Methods of other papers get the poses as they
/// are. Throws UsageError where poses shall be refined without stereo.
bool RefinesPoses(const RunOptions& options, const Plan& plan);

/// has_poses: the scene's cameras are known; sensor: how many of its photos have a depth of a sensor. On a CPU that
/// --device cpu does not ask for, networks of the size of Stable Virtual Camera or VGGT take no part: --oracle auto
/// does without. Throws InputError for weights that are asked for and missing, UsageError for a device that cannot be
/// used and for such a network that is asked for.
Plan MakePlan(const RunOptions& options, bool has_poses, SensorDepth sensor = SensorDepth::kNone);

/// Plan for a finished run that is only evaluated or rendered: device and LPIPS, no other network.
Plan MakePlanToEvaluate(const RunOptions& options);

/// Takes into the plan what the size of the run has settled (run_size.h): the images, and that a draft of many photos
/// proposes nothing.
void TakeSize(const RunOptions& settled, Plan* plan);

}  // namespace oraclegs
