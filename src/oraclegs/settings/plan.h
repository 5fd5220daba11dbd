#pragma once
// What a run does and with what: everything automatic is settled here, once, from the options and from what lies on
// this machine. (What depends on the images' depth is settled after stage "depth": train_inputs.h.)

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "oraclegs/core/device.h"
#include "oraclegs/core/progress.h"
#include "oraclegs/settings/device.h"
#include "oraclegs/settings/options.h"
#include "oraclegs/settings/vggt_weights.h"
#include "oraclegs/settings/weights.h"

namespace oraclegs {

/// True when the run's own proposers are asked.
bool ProposesViews(const RunOptions& options);
/// True when there are proposals: the run's own, or those of a folder.
bool HasProposals(const RunOptions& options);
/// True when a stage after "sfm" needs depth: a dense start, depth in the loss, or proposals; false for --depth-prior
/// none.
bool NeedsDepth(const RunOptions& options);

/// Which oracle classifies the proposals.
struct OracleChoice {
  OracleKind kind = OracleKind::kConsistency;
  std::optional<VggtWeights> weights = {};  ///< of the kinds that ask VGGT

  /// Tells one choice from another, for the key of a stage.
  std::string Key() const { return Word(kind) + (weights ? " " + weights->fingerprint : ""); }
};

/// Throws InputError as RequireVggtWeights does, UsageError for --vggt-layers that the network does not have.
OracleChoice ChooseOracle(const RunOptions& options);

/// Reports what --oracle auto became.
void ReportOracleChoice(const RunOptions& options, const OracleChoice& choice, const Listener& listener);

struct Plan {
  DeviceSupport support;
  Device device;                             ///< of training, rendering and networks
  bool needs_depth = false;                  ///< stage "depth" is run
  bool proposes = false;                     ///< the run's own proposers are asked
  bool has_proposals = false;                ///< they are, or a folder has proposals
  DepthSource depth = {};                    ///< where depth is needed
  OracleChoice oracle = {};                  ///< where there are proposals
  std::optional<VggtWeights> poses = {};     ///< of --poses vggt, where poses are to be found; nothing = colmap
  std::vector<std::filesystem::path> lpips;  ///< files; none: there is no LPIPS

  bool Uses(const RunOptions& options, ProposerChoice proposer) const {
    return proposes && options.propose.Uses(proposer);
  }
};

/// has_poses: the scene's cameras are known. Throws InputError for weights that are asked for and not there, UsageError
/// for a device that cannot be used.
Plan MakePlan(const RunOptions& options, bool has_poses);

/// The plan of a finished run that is only looked at: device and LPIPS, no other network.
Plan MakePlanToEvaluate(const RunOptions& options);

}  // namespace oraclegs
