#include "oraclegs/stages/stage_works.h"

#include <algorithm>
#include <memory>
#include <set>
#include <string>
#include <utility>

#include "oraclegs/core/error.h"
#include "oraclegs/core/text.h"
#include "oraclegs/networks/loader.h"
#include "oraclegs/settings/device.h"
#include "oraclegs/sfm/choose_pairs.h"
#include "oraclegs/sfm/register_views.h"
#include "oraclegs/stages/stage_seconds.h"
#include "oraclegs/stages/stereo_of_run.h"
#include "oraclegs/stages/vggt_registration.h"
#include "oraclegs/workspace/non_commercial.h"

namespace oraclegs {
namespace {

void AddRegisterKey(Run* run, Fingerprint* key) {
  key->Add(run->photos);
  if (!run->options.masks.masks.empty()) {
    for (const SceneView& view : run->scene.views) key->Add(run->files.Of(view.mask_path));
  }
  if (run->needed) {
    for (const SceneView& view : run->scene.views) key->Add(view.name);
  }
  if (run->plan.poses) key->Add("vggt").Add(run->plan.poses->fingerprint);
}

void UndoRegister(Run* run, const nlohmann::json& record) {
  if (record.is_null()) return;  // what a stopped run left is used, if it is of the same photos
  run->listener(Warning{"the photos, or what finds their poses, have changed: poses are found anew"});
  std::error_code ignored;  // what cannot be removed cannot be written either, which is reported then
  std::filesystem::remove_all(run->workspace.sfm(), ignored);
}

/// ALIKED, loaded when it is asked for: the photos of most runs register without it.
FeatureFinder LearnedFeaturesOf(const Plan& plan, const Listener& listener) {
  if (plan.keypoints.empty()) return {};
  return [&, network = std::shared_ptr<const KeypointNetwork>()](const ImageF& rgb) mutable {
    if (!network) {
      const Networks& networks = GetNetworks();
      network = networks.LoadKeypoints(plan.keypoints, DeviceOfNetworks(networks, plan.device, listener));
    }
    ImageFeatures found = network->Find(rgb, KeypointOptions());
    return LearnedFeatures{std::move(found.keypoints), std::move(found.descriptors)};
  };
}

/// True when matches would place a photo that has no camera.
bool LacksMatches(const std::filesystem::path& report) {
  static const std::set<std::string> kStatuses = {"no_matches", "few_matches", "elsewhere", "does_not_fit"};
  try {
    const nlohmann::json json = ReadRunJson(report);
    const nlohmann::json& views = json.at("views");
    return std::any_of(views.begin(), views.end(),
                       [](const nlohmann::json& view) { return kStatuses.count(view.at("status")) > 0; });
  } catch (const std::exception&) {
    return false;  // there is none yet, or it is damaged
  }
}

/// Advice where photos stay out; empty where it was tried, cannot be, or would not help.
std::string AdviceToLearn(const Run& run) {
  if (!run.plan.keypoints.empty() || !HasNetworksLibrary()) return "";
  if (!LacksMatches(run.workspace.sfm() / "registration.json")) return "";
  return fmt::format(
      "features of a network may join them: `oraclegs models fetch {} --accept-license`, then the same "
      "command with --overwrite",
      kKeypointModel);
}

void RegisterWithColmap(Run* run) {
  try {
    const ConfirmedShares confirmed = [&](const Scene& model) { return ConfirmedDepth(model, run->plan.device); };
    run->scene = RegisterViews(run->scene, run->workspace.sfm(), run->listener,
                               LearnedFeaturesOf(run->plan, run->listener), confirmed);
  } catch (const InputError& failure) {
    const std::string advice = AdviceToLearn(*run);
    if (advice.empty()) throw;
    throw InputError("{}; {}", failure.what(), advice);
  }
  if (const std::string advice = AdviceToLearn(*run); !advice.empty()) {
    run->listener(Note{"photos are not registered: " + advice});
  }
}

/// Finds poses, or reads those that stand.
void Register(Run* run) {
  if (!run->plan.poses) return RegisterWithColmap(run);
  run->scene = RegisterWithVggt(run->scene, *run->plan.poses, run->workspace.sfm(), run->listener, run->plan.device);
}

std::optional<nlohmann::json> MakeRegister(Run* run, const std::string&) {
  const size_t photos = run->scene.views.size();
  Register(run);
  nlohmann::json record = {{"photos", photos}, {"registered", run->scene.views.size()}, {"files", {"sfm"}}};
  if (const std::optional<VggtWeights>& network = run->plan.poses) {
    record["network"] = {
        {"name", network->name}, {"fingerprint", network->fingerprint}, {"commercial", network->commercial}};
    NoteNetwork(*network, &record);
  }
  return record;
}

/// Poses found anew would be others, and what was trained with the old ones would be lost.
bool LoadRegister(Run* run) {
  if (!HasResults(run->workspace)) {
    Register(run);
    return true;
  }
  try {
    ReadRunJson(run->workspace.sfm() / "inputs.json");  // damaged or missing, it would have them found anew
    Register(run);
  } catch (const InputError& damage) {
    throw RunError("{}; the results were trained with these poses: bring the file back, or start anew with --overwrite",
                   damage.what());
  }
  return true;
}

}  // namespace

StageWork RegisterStage() {
  return {.wanted = [](const Run& run) { return !run.photos.empty(); },
          .own = AddRegisterKey,
          .undo = UndoRegister,
          .make = MakeRegister,
          .load = LoadRegister,
          .summary =
              [](const nlohmann::json& r) {
                return fmt::format("{} of {}", CountIn(r, "registered"), Counted(CountIn(r, "photos"), "photo"));
              },
          .seconds =
              [](const EstimateInput& input) {
                constexpr double kMapping = 3, kMappingOfPhoto = 1, kCoarse = 0.3;
                // Many photos usually register by coarse features.
                const double share = input.photos > kMaxImagesToMatchAll ? kCoarse : 1;
                return kMapping + share * (SecondsOfFeatures(input, input.photos) + kMappingOfPhoto * input.photos);
              },
          .uses_network = [](const Run& run) { return run.plan.poses.has_value(); }};
}

std::optional<VggtWeights> PoseNetworkOf(const RunOptions& options, const Workspace& workspace) {
  if (options.input.poses != PoseSource::kVggt) return std::nullopt;
  const nlohmann::json record = workspace.Record("register");
  try {
    return RequireVggtWeights(options.weights.vggt_weights, "--poses vggt");
  } catch (const InputError&) {
    if (!record.is_object() || !record.contains("network")) throw;
    const nlohmann::json& used = record["network"];
    return VggtWeights{"", used.value("name", ""), used.value("fingerprint", ""), used.value("commercial", false)};
  }
}

}  // namespace oraclegs
