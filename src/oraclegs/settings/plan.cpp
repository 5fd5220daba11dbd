#include "oraclegs/settings/plan.h"

#include "oraclegs/networks/loader.h"
#include "oraclegs/validate/vggt_oracle.h"

namespace oraclegs {
namespace {

void RequireLayers(const RunOptions& options, const VggtWeights& weights) {
  if (weights.layers == 0) return;  // the network's weights are missing; loading them reports that
  RequireAttentionLayers(AttentionLayersOf(options.validate), weights.layers, weights.name);
}

/// Bytes of weights from which a network takes hours or days on a CPU. Those of Stable Virtual Camera and VGGT have
/// five times as many.
constexpr int64_t kLargeNetwork = 1'000'000'000;
constexpr const char* kSevaWord = "seva";

bool IsLarge(const std::vector<std::filesystem::path>& files) {
  int64_t bytes = 0;
  for (const std::filesystem::path& file : files) bytes += BytesOf(SafetensorsFile::Open(file));
  return bytes >= kLargeNetwork;
}

/// Throws UsageError for a pass of VGGT over all images that the other options of the oracle do not allow: nothing can
/// be held out of it, and its views differ in size.
void RequirePass(const ValidateOptions& options) {
  const bool asks_vggt = options.oracle != OracleKind::kConsistency && options.oracle != OracleKind::kUniform;
  if (!asks_vggt || options.oracle_pass == OraclePass::kChunk) return;
  if (options.oracle == OracleKind::kVggt && options.oracle_mode == AttentionMode::kOfficial && !options.calibrate)
    return;
  throw UsageError(
      "--set oracle-pass=all: needs --oracle vggt, --set oracle-mode=official and --set calibrate=false, as "
      "--preset paper-mipnerf360-12 sets them");
}

std::string OnCpu(const char* network, const char* time, const std::string& why) {
  return fmt::format("{} would compute on the CPU, for {}: {}, or accept the CPU with --device cpu", network, time,
                     why);
}

/// Keeps large networks off a CPU that nobody asked for. Throws UsageError where one is asked for itself.
void RequireGpuForLargeNetworks(const RunOptions& options, Plan* plan) {
  const bool seva = plan->Uses(options, kSevaWord) && IsLarge(FindWeights(kSevaWord, options.weights.seva_weights));
  const bool vggt = plan->oracle.weights && plan->oracle.weights->bytes >= kLargeNetwork;
  if (!seva && !vggt) return;
  const std::string why = WhyNetworksOnCpu(options.device.device, plan->device, plan->support);
  if (why.empty()) return;
  if (seva) throw UsageError("--proposers {}: {}", kSevaWord, OnCpu("Stable Virtual Camera", "days", why));
  const std::string of_vggt = OnCpu("VGGT", "hours", why);
  if (!options.validate.oracle.is_auto()) throw UsageError("--oracle {}: {}", Word(plan->oracle.kind), of_vggt);
  plan->oracle = {OracleKind::kConsistency, {}, of_vggt};
}

}  // namespace

bool RefinesPoses(const RunOptions& options, const Plan& plan) {
  const Auto<PoseRefining>& asked = options.depth.refine_poses;
  const bool has_stereo = plan.needs_depth && plan.depth.prior != DepthPrior::kMonocular;
  if (asked == PoseRefining::kOn && !has_stereo) {
    throw UsageError("--refine-poses on: needs depth from stereo, which these options leave out; leave it out, too");
  }
  return has_stereo && asked != PoseRefining::kOff && options.method.method.empty();
}

bool ProposesViews(const RunOptions& options) {
  return !options.propose.Words().empty() && options.trajectory.proposals != 0 &&
         options.train.schedule != ScheduleKind::kNone;
}

bool HasProposals(const RunOptions& options) {
  return ProposesViews(options) || !options.propose.proposal_folder.empty();
}

bool NeedsDepth(const RunOptions& options) {
  if (options.depth.depth_prior == DepthPrior::kNone) return false;
  const Auto<StartKind>& init = options.start.init;
  return HasProposals(options) || init.is_auto() || init == StartKind::kDense || init == StartKind::kHybrid ||
         options.train.depth_weight > 0 || options.train.prune_floaters || options.method.Settings().UsesDepth();
}

OracleChoice ChooseOracle(const RunOptions& options) {
  RequirePass(options.validate);
  const Auto<OracleKind>& asked = options.validate.oracle;
  if (asked == OracleKind::kConsistency || asked == OracleKind::kUniform) return {asked.value()};
  if (!asked.is_auto()) {
    const std::string needs = "--oracle " + Word(asked.value());
    OracleChoice choice{asked.value(), RequireVggtWeights(options.weights.vggt_weights, needs)};
    RequireLayers(options, *choice.weights);
    RequireNetworksLibrary(needs);
    return choice;
  }
  auto weights = FindVggtWeights(options.weights.vggt_weights);
  if (!weights || !HasNetworksLibrary()) return {OracleKind::kConsistency};
  RequireLayers(options, *weights);
  return {OracleKind::kVggtAndConsistency, std::move(weights)};
}

VggtPrecision SettlePrecision(const ValidateOptions& asked, Device device) {
  return asked.vggt_precision.ValueOr(UsualVggtPrecision(device.is_cuda()));
}

void ReportOracleChoice(const RunOptions& options, const OracleChoice& choice, const Listener& listener) {
  if (!options.validate.oracle.is_auto()) return;
  if (!choice.why_no_vggt.empty()) {
    listener(Note{fmt::format("oracle: consistency of the images; {}", choice.why_no_vggt)});
    return;
  }
  if (choice.weights) {
    listener(Note{fmt::format("oracle: {} with the images ({})", choice.weights->name, choice.weights->path.string())});
    return;
  }
  if (!HasNetworksLibrary() && FindVggtWeights(options.weights.vggt_weights)) {
    listener(Note{"oracle: consistency of the images, without VGGT; " + WhyNoNetworks()});
  }
}

Plan MakePlan(const RunOptions& options, bool has_poses, SensorDepth sensor) {
  Plan plan = MakePlanToEvaluate(options);
  plan.needs_depth = NeedsDepth(options);
  plan.proposes = ProposesViews(options);
  plan.has_proposals = HasProposals(options);
  if (!plan.needs_depth && !options.depth.depth_folder.empty()) {
    throw UsageError("--set depth-folder: nothing in this run uses depth; leave out --depth-prior none");
  }
  if (plan.needs_depth) plan.depth = ChooseDepthSource(options, sensor);
  plan.refines_poses = RefinesPoses(options, plan);
  if (plan.has_proposals) plan.oracle = ChooseOracle(options);
  if (!has_poses && options.input.poses == PoseSource::kVggt) {
    plan.poses = RequireVggtWeights(options.weights.vggt_weights, "--poses vggt");
    RequireNetworksLibrary("--poses vggt");
  }
  if (!has_poses && options.input.poses != PoseSource::kVggt) plan.keypoints = FindKeypointWeights();
  if (plan.proposes && options.propose.proposal_size == ProposalSize::kOwn && !plan.Uses(options, "seva")) {
    throw UsageError("--set proposal-size=own: only --proposers seva has a size of its own");
  }
  for (const KnownProposer& known : KnownProposers()) {
    if (!known.networks.empty() && plan.Uses(options, known.word)) {
      RequireNetworksLibrary(fmt::format("--proposers {}", known.word));
    }
  }
  RequireGpuForLargeNetworks(options, &plan);
  return plan;
}

Plan MakePlanToEvaluate(const RunOptions& options) {
  Plan plan;
  plan.support = ProbeDevices();
  plan.device = ChooseDevice(options.device.device, plan.support);
  plan.lpips = FindLpips(options.weights);
  if (options.weights.lpips == LpipsUse::kRequired) RequireNetworksLibrary("--lpips required");
  if (!options.weights.lpips_weights.empty()) RequireNetworksLibrary("--lpips-weights");
  if (!HasNetworksLibrary()) plan.lpips.clear();
  return plan;
}

void TakeSize(const RunOptions& settled, Plan* plan) {
  plan->image = settled.image.Settled();
  plan->proposes = ProposesViews(settled);
  plan->has_proposals = HasProposals(settled);
}

}  // namespace oraclegs
