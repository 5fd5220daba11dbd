#include "oraclegs/pipeline/run.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "oraclegs/core/files.h"
#include "oraclegs/core/text.h"
#include "oraclegs/pipeline/live/live.h"
#include "oraclegs/pipeline/report/run_document.h"
#include "oraclegs/pipeline/settings/missing_networks.h"
#include "oraclegs/pipeline/stages.h"
#include "oraclegs/pipeline/stages/register_stage.h"
#include "oraclegs/render/constants.h"
#include "oraclegs/scene/loaded_view.h"
#include "oraclegs/scene/read_scene.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

/// Of the images of a scene without poses; "" for a scene with poses.
std::string PhotosFingerprint(const Scene& scene, FileHashes* files) {
  if (scene.HasPoses()) return "";
  std::vector<int> all(scene.views.size());
  std::iota(all.begin(), all.end(), 0);
  return ViewsFingerprint(scene, all, 1, files);
}

void ReportSplit(const nlohmann::json& split, const Listener& listener) {
  for (const char* part : {"train", "test"}) {
    const auto names = split.at(part).get<std::vector<std::string>>();
    listener(Note{fmt::format("{} {} views{}{}", names.size(), std::string(part) == "train" ? "training" : "test",
                              names.empty() ? "" : ": ", fmt::join(names, ", "))});
  }
}

/// Throws InputError when a view's image is too large to be rendered.
void RequireRenderable(const Scene& scene, int downscale) {
  for (const SceneView& view : scene.views) {
    const int width = WorkingSize(view.intrinsics.width, downscale),
              height = WorkingSize(view.intrinsics.height, downscale);
    if (width <= kMaxRenderSide && height <= kMaxRenderSide) continue;
    throw InputError("{}: is {} x {} pixels at --downscale {}, at most {} a side can be rendered; raise --downscale",
                     view.image_path.string(), width, height, downscale, kMaxRenderSide);
  }
}

/// Published scores are of the dataset's own smaller images, where it has some. Throws InputError where it must.
void CheckSmallerCopies(const Scene& scene, const ImageOptions& options, const Listener& listener) {
  const int downscale = options.downscale;
  const bool required = options.smaller_copies == SmallerCopies::kRequired;
  if (downscale == 1 || (scene.format != SceneFormat::kColmap && !required)) return;
  const bool has_smaller = std::any_of(scene.views.begin(), scene.views.end(), [&](const SceneView& view) {
    return ImageFile(view, downscale) != view.image_path;
  });
  if (has_smaller) return;
  if (required) {
    throw InputError(
        "{}: has no folder images_{}, as --smaller-copies required asks for; get the dataset's, or say "
        "--smaller-copies auto to resize the photos here",
        scene.root.string(), downscale);
  }
  listener(
      Note{fmt::format("{}: has no folder images_{}; the photos are resized here, and scores differ a little from "
                       "those of a dataset that has it",
                       scene.root.string(), downscale)});
}

Scene Read(const fs::path& root, const RunOptions& options, const Listener& listener) {
  if (!IsUtf8(options.input.images.string())) {
    throw InputError("{}: the name of the --images folder is not valid UTF-8; rename it",
                     EscapeBytes(options.input.images.string()));
  }
  SceneReadOptions read;
  read.images = options.input.images;
  Scene scene = ReadScene(root, read, listener);
  RequireRenderable(scene, options.image.downscale);
  CheckSmallerCopies(scene, options.image, listener);
  return scene;
}

/// Lists of views in files become options of the run, so that it is continued without the files.
RunRequest WithListsRead(const RunRequest& request) {
  RunRequest read = request;
  read.options.split = WithListsRead(request.options.split);
  return read;
}

/// Poses where there are none yet, and the split.
void FindPosesAndSplit(Run* run) {
  run->photos = PhotosFingerprint(run->scene, &run->files);
  if (!run->photos.empty()) RunStage(run, "register");
  run->split = SplitViews(run->scene, run->options.split);
  const nlohmann::json json = SplitToJson(run->scene, run->split);
  ReportSplit(json, run->listener);
  WriteFileAtomically(run->workspace.split(), json.dump(2) + "\n");
}

}  // namespace

PosedScene ReadPosedScene(const fs::path& root, const RunOptions& options, const Listener& listener) {
  Scene scene = Read(root, options, listener);
  if (!scene.HasPoses()) {
    throw InputError("{}: these photos have no poses; run `oraclegs reconstruct` and name its workspace instead",
                     root.string());
  }
  Split split = SplitViews(scene, WithListsRead(options.split));
  return {std::move(scene), std::move(split)};
}

Run StartRun(const RunRequest& asked, const Listener& listener) {
  CheckRunOptions(asked.options);
  const RunRequest request = WithListsRead(asked);
  RequireOutsideScene(request.out, request.scene);
  Scene scene = Read(request.scene, request.options, listener);
  RequireOutsideScene(request.out, scene, request.options.input.images);
  const fs::path& proposals = request.options.propose.proposal_folder;
  if (!proposals.empty()) RequireApart(request.out, proposals);
  const bool has_poses = scene.HasPoses();
  if (has_poses && request.options.input.poses == PoseSource::kVggt) {
    listener(Note{"--poses vggt: the scene has poses, which are used"});
  }
  // What is asked for and missing is an error before anything is written.
  const RunOptions options = WithNetworksAtHand(request.options, has_poses, listener);
  Plan plan = MakePlan(options, has_poses);
  SplitViews(scene, options.split);  // which image registers is unknown, but what all of them cannot fill is refused
  Workspace workspace = Workspace::Claim(request.out, request.scene, options, request.overwrite);
  Run run{options, request.version, std::move(plan), std::move(workspace), std::move(scene), {}, listener, ""};
  run.live = std::make_shared<Live>(run.workspace, listener);
  run.listener = run.live->AsListener();
  if (run.options.report.report) run.on_training = WriteStartDocument;
  if (request.on_claimed) request.on_claimed();
  Live::Guard(run.live.get(), [&] { FindPosesAndSplit(&run); });
  return run;
}

Run OpenRun(const RunRequest& asked, const Listener& listener) {
  CheckRunOptions(asked.options);
  const RunRequest request = WithListsRead(asked);
  const SavedRun saved = ReadSavedRun(request.out);
  const std::string difference = DescribeDifference(saved.options, request.options);
  if (!difference.empty()) {
    throw InputError("{}: was run with other options ({}); leave them out", request.out.string(), difference);
  }
  Scene scene = Read(saved.scene, request.options, listener);
  Workspace workspace = Workspace::Open(request.out);
  Plan plan = MakePlanToEvaluate(request.options);
  if (!scene.HasPoses()) plan.poses = PoseNetworkOf(request.options, workspace);
  Run run{request.options, request.version, std::move(plan), std::move(workspace), std::move(scene), {}, listener, ""};
  FindPosesAndSplit(&run);
  return run;
}

}  // namespace oraclegs
