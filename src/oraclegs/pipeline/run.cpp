#include "oraclegs/pipeline/run.h"

#include <optional>
#include <utility>

#include "oraclegs/core/files.h"
#include "oraclegs/pipeline/settings/device.h"
#include "oraclegs/pipeline/workspace/fingerprint.h"
#include "oraclegs/pipeline/settings/missing_networks.h"
#include "oraclegs/pipeline/workspace/non_commercial.h"
#include "oraclegs/pipeline/settings/oracle_choice.h"
#include "oraclegs/pipeline/stages/propose_stage.h"
#include "oraclegs/pipeline/stages/vggt_registration.h"
#include "oraclegs/scene/loaded_view.h"
#include "oraclegs/sfm/triangulate.h"
#include "oraclegs/scene/scene_validation.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxSide = 32768;  // pixels; the rasterizer renders no larger pictures

std::vector<int> AllViews(const Scene& scene) {
  std::vector<int> all(scene.views.size());
  for (size_t i = 0; i < all.size(); ++i) all[i] = static_cast<int>(i);
  return all;
}

/// Who finds cameras; nothing = colmap.
std::optional<VggtWeights> PoseNetwork(const RunOptions& options) {
  if (options.input.poses != "vggt") return std::nullopt;
  return RequireVggtWeights(options.weights.vggt_weights, "--poses vggt");
}

/// The same for a workspace that may have its poses already, which stand without the weights.
std::optional<VggtWeights> PoseNetwork(const RunOptions& options, const nlohmann::json& record) {
  if (options.input.poses != "vggt" || !record.is_object() || !record.contains("network")) return PoseNetwork(options);
  try {
    return PoseNetwork(options);
  } catch (const InputError&) {
    const nlohmann::json& used = record["network"];
    return VggtWeights{"", used.value("name", ""), used.value("fingerprint", ""), used.value("commercial", false)};
  }
}

Scene Register(Workspace* workspace, const Scene& photos, const RunOptions& options, const Listener& listener) {
  const std::optional<VggtWeights> network = PoseNetwork(options, workspace->Record("register"));
  std::string key = ViewsFingerprint(photos, AllViews(photos));
  if (network) key = Fingerprint().Add(key).Add("vggt").Add(network->fingerprint).Hex();
  const bool done = workspace->IsDone("register", key);
  if (!done) {
    if (!workspace->Record("register").is_null())
      listener(Warning{"the photographs, or what finds their poses, have changed: poses are found anew"});
    std::error_code ignored;  // what cannot be removed cannot be written either, which is told then
    fs::remove_all(workspace->sfm(), ignored);
  }
  const StageClock clock("register", listener);
  Scene scene = network ? RegisterWithVggt(photos, *network, workspace->sfm(), listener,
                                           ChooseDevice(options.device.device, ProbeDevices()))
                        : RegisterPhotos(photos, workspace->sfm(), listener);
  const double seconds = clock.Finish();
  if (!done) {
    nlohmann::json record = {{"key", key},
                             {"seconds", seconds},
                             {"photographs", photos.views.size()},
                             {"registered", scene.views.size()},
                             {"files", {"sfm"}}};
    if (network) {
      record["network"] = {
          {"name", network->name}, {"fingerprint", network->fingerprint}, {"commercial", network->commercial}};
      NoteNetwork(*network, &record);
    }
    workspace->MarkDone("register", record);
  }
  return scene;
}

void TellSplit(const nlohmann::json& split, const Listener& listener) {
  for (const char* part : {"train", "test"}) {
    const auto names = split.at(part).get<std::vector<std::string>>();
    listener(Note{fmt::format("{} {} views{}{}", names.size(), std::string(part) == "train" ? "training" : "test",
                              names.empty() ? "" : ": ", fmt::join(names, ", "))});
  }
}

void WriteSplit(const Run& run) {
  const nlohmann::json json = SplitToJson(run.scene, run.split);
  TellSplit(json, run.listener);
  WriteFileAtomically(run.workspace.split(), json.dump(2) + "\n");
}

/// Throws InputError when a view's picture is too large to be rendered.
void RequireRenderable(const Scene& scene, int downscale) {
  for (const SceneView& view : scene.views) {
    const int width = WorkingSize(view.lens.width, downscale), height = WorkingSize(view.lens.height, downscale);
    if (width <= kMaxSide && height <= kMaxSide) continue;
    throw InputError("{}: is {} x {} pixels at --downscale {}, at most {} a side can be rendered; raise --downscale",
                     view.image_path.string(), width, height, downscale, kMaxSide);
  }
}

Scene Read(const fs::path& root, const RunOptions& options, const Listener& listener) {
  if (!IsUtf8(options.input.images.string())) {
    throw InputError("{}: the name of the --images folder is not valid UTF-8; rename it",
                     EscapeBytes(options.input.images.string()));
  }
  SceneReadOptions read;
  read.images = options.input.images;
  Scene scene = ReadScene(root, read, listener);
  RequireRenderable(scene, options.photo.downscale);
  return scene;
}

/// Throws InputError for weights that are asked for and missing, before anything is written; with --allow-fallback the
/// request without them.
RunRequest WithWeights(RunRequest request, const Scene& scene, const Listener& listener) {
  const bool has_poses = scene.HasPoses();
  RunOptions& options = request.options;
  if (has_poses && options.input.poses == "vggt") listener(Note{"--poses vggt: the scene has poses, which are used"});
  options = WithNetworksAtHand(options, has_poses, listener);
  if (ProposesViews(options) || !options.propose.proposal_folder.empty()) ChooseOracle(options);
  return request;
}

Run WithPosesAndSplit(const RunRequest& request, Workspace workspace, Scene scene, const Listener& listener) {
  if (!scene.HasPoses()) scene = Register(&workspace, scene, request.options, listener);
  Split split = SplitViews(scene, request.options.split);
  Run run{request.options, request.version, std::move(workspace), std::move(scene), std::move(split), listener};
  WriteSplit(run);
  return run;
}

}  // namespace

PosedScene ReadPosedScene(const fs::path& root, const RunOptions& options, const Listener& listener) {
  Scene scene = Read(root, options, listener);
  if (!scene.HasPoses()) {
    throw InputError("{}: these photographs have no poses; run `oraclegs reconstruct` and name its workspace instead",
                     root.string());
  }
  Split split = SplitViews(scene, options.split);
  return {std::move(scene), std::move(split)};
}

Run StartRun(const RunRequest& asked, const Listener& listener) {
  CheckRunOptions(asked.options);
  RequireOutsideScene(asked.out, asked.scene);
  Scene scene = Read(asked.scene, asked.options, listener);
  RequireOutsideScene(asked.out, scene, asked.options.input.images);
  const fs::path& proposals = asked.options.propose.proposal_folder;
  if (!proposals.empty()) RequireApart(asked.out, proposals);
  const RunRequest request = WithWeights(asked, scene, listener);
  // A registered photograph is not yet known, but what all of them together cannot fill is refused at once.
  SplitViews(scene, request.options.split);
  Workspace workspace = Workspace::Claim(request.out, request.scene, request.options, request.overwrite);
  return WithPosesAndSplit(request, std::move(workspace), std::move(scene), listener);
}

Run OpenRun(const RunRequest& request, const Listener& listener) {
  CheckRunOptions(request.options);
  const SavedRun saved = ReadSavedRun(request.out);
  const std::string difference = DescribeDifference(saved.options, request.options);
  if (!difference.empty()) {
    throw InputError("{}: was run with other options ({}); leave them out", request.out.string(), difference);
  }
  Scene scene = Read(saved.scene, request.options, listener);
  return WithPosesAndSplit(request, Workspace::Open(request.out), std::move(scene), listener);
}

StageClock::StageClock(std::string stage, const Listener& listener)
    : stage_(std::move(stage)), listener_(listener), start_(std::chrono::steady_clock::now()) {
  listener_(StageStarted{stage_});
}

double StageClock::Seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

double StageClock::Finish() const {
  const double seconds = Seconds();
  listener_(StageFinished{stage_, seconds});
  return seconds;
}

}  // namespace oraclegs
