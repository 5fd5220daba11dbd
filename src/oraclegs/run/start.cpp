#include "oraclegs/run/start.h"

#include <algorithm>
#include <utility>

#include "oraclegs/capture/cut_spheres.h"
#include "oraclegs/capture/import.h"
#include "oraclegs/capture/video.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/text.h"
#include "oraclegs/datasets/read_scene.h"
#include "oraclegs/gaussians/ply.h"
#include "oraclegs/output/live/live.h"
#include "oraclegs/output/report/run_document.h"
#include "oraclegs/proposers/proposer_rows.h"
#include "oraclegs/render/constants.h"
#include "oraclegs/run/needed_photos.h"
#include "oraclegs/run/network_needs.h"
#include "oraclegs/run/stages.h"
#include "oraclegs/scene/declared_split.h"
#include "oraclegs/scene/frame_comments.h"
#include "oraclegs/scene/gps_scale.h"
#include "oraclegs/scene/loaded_view.h"
#include "oraclegs/settings/missing_networks.h"
#include "oraclegs/settings/run_size.h"
#include "oraclegs/stages/refined_poses.h"
#include "oraclegs/stages/stage_works.h"
#include "oraclegs/workspace/frame_file.h"
#include "oraclegs/workspace/stage_records.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

/// Fingerprint of the images of a scene without poses; "" for a scene with poses.
std::string PhotosFingerprint(const Scene& scene, FileHashes* files) {
  if (scene.HasPoses()) return "";
  return ViewsFingerprint(scene, AllViews(scene), ImageOptions(), files);
}

void ReportSplit(const nlohmann::json& split, const Listener& listener) {
  for (const char* part : {"train", "test"}) {
    const auto names = split.at(part).get<std::vector<std::string>>();
    listener(
        Note{fmt::format("{}{}{}", Counted(names.size(), std::string(part) == "train" ? "training view" : "test view"),
                         names.empty() ? "" : ": ", fmt::join(names, ", "))});
  }
}

/// Throws InputError when a view's image is too large to be rendered.
void RequireRenderable(const Scene& scene, const ImageOptions& options) {
  for (const SceneView& view : scene.views) {
    const PixelSize size = WorkingSize({view.intrinsics.width, view.intrinsics.height}, options);
    if (size.width <= kMaxRenderSide && size.height <= kMaxRenderSide) continue;
    throw InputError("{}: would be used at {} x {} pixels, at most {} a side can be rendered; lower --max-size",
                     view.image_path.string(), size.width, size.height, kMaxRenderSide);
  }
}

/// Checks for the dataset's own smaller images, on which published scores are. Throws InputError where they are
/// required.
void CheckSmallerCopies(const Scene& scene, const ImageOptions& options, const Listener& listener) {
  const int downscale = options.downscale;
  const bool required = options.smaller_copies == SmallerCopies::kRequired;
  if (downscale == 1 || (scene.format != SceneFormat::kColmap && !required)) return;
  const bool has_smaller = std::any_of(scene.views.begin(), scene.views.end(), [&](const SceneView& view) {
    return ImageFile(view, options) != view.image_path;
  });
  if (has_smaller) return;
  if (required) {
    throw InputError(
        "{}: has no folder images_{}, as --set smaller-copies=required asks for; get the dataset's, or say "
        "--set smaller-copies=auto to resize the photos here",
        scene.root.string(), downscale);
  }
  listener(
      Note{fmt::format("{}: has no folder images_{}; the photos are resized here, and scores differ a little from "
                       "those of a dataset that has it",
                       scene.root.string(), downscale)});
}

/// `faces`: where the views of spherical photos are to lie; empty = they are refused.
Scene Read(const fs::path& root, const RunOptions& options, const fs::path& faces, const Listener& listener) {
  if (!IsUtf8(options.input.images.string())) {
    throw InputError("{}: the name of the --images folder is not valid UTF-8; rename it",
                     EscapeBytes(options.input.images.string()));
  }
  const SceneReadOptions read{options.input.images, options.input.allow_outside, faces, options.image.spheres,
                              !options.masks.masks.empty()};
  Scene scene = ReadScene(root, read, listener);
  CheckSmallerCopies(scene, options.image.Settled(), listener);
  ReportSplitLists(scene, options.split, listener);
  return scene;
}

/// Size of the run that `request` continues; null where it starts one, also in the folder of a run with other options
/// or of another scene that has no results yet.
nlohmann::json SavedSize(const RunRequest& request) {
  if (!IsWorkspace(request.out) || request.overwrite) return nullptr;
  const SavedRun saved = ReadSavedRun(request.out);
  std::error_code ignored;
  const bool same_options = DescribeDifference(saved.options, request.options, saved.size).empty() ||
                            AsksForMoreIterations(saved, request.options);
  return same_options && fs::equivalent(saved.scene, request.scene, ignored) ? saved.size : nlohmann::json();
}

/// Throws InputError for another number of frames of a video, which would replace the photos that the run was made
/// from.
void RequireSameFrames(const RunRequest& request, const nlohmann::json& saved_size) {
  const Auto<int>& now = request.options.capture.frames;
  const nlohmann::json before =
      saved_size.is_object() ? saved_size.value("frames", nlohmann::json()) : nlohmann::json();
  if (now.is_auto() || !before.is_number() || before == now.value()) return;
  if (std::none_of(request.inputs.begin(), request.inputs.end(), LooksLikeVideo)) return;
  if (!HasResults(WorkspacePaths(request.out))) return;
  throw InputError(
      "{}: holds a run with other options (--frames was {}, now is {}); give the same options to continue it, choose "
      "another -o, or start anew with --overwrite",
      request.out.string(), before.dump(), now.value());
}

/// Throws InputError for inputs inside the workspace, whose files may be removed before they are read.
void RequireInputsOutside(const fs::path& out, const std::vector<fs::path>& inputs) {
  std::error_code ignored;
  const fs::path workspace = fs::weakly_canonical(fs::absolute(out, ignored), ignored);
  for (const fs::path& input : inputs) {
    const fs::path place = fs::weakly_canonical(fs::absolute(input, ignored), ignored);
    const auto [end, rest] = std::mismatch(workspace.begin(), workspace.end(), place.begin(), place.end());
    if (end != workspace.end()) continue;
    throw InputError("{}: lies in the workspace {}, whose files are written anew; choose another -o, or move it",
                     input.string(), out.string());
  }
}

/// Refuses a split that not even all images fill; which of them register is not known yet.
SceneSize SizeOf(const Scene& scene, const SplitOptions& split) {
  return SizeOf(scene, static_cast<int>(SplitViews(scene, split).train.size()));
}

/// Options with the size of the run settled; a run that is continued takes it from `saved`.
RunOptions SettleSize(const RunOptions& asked, const Scene& scene, Device device, const nlohmann::json& saved,
                      const Listener& listener) {
  const SceneSize size = SizeOf(scene, asked.split);
  const TrainingMachine machine{device.is_cuda(), device.is_cuda() ? FreeBytes(device) : 0};
  const RunOptions known = WithBackground(WithSavedSize(asked, saved), scene);
  RunOptions settled = WithSize(known, size, machine);
  CheckRunOptions(settled);
  RequireRenderable(scene, settled.image.Settled());
  if (const std::string text = DescribeSize(asked, settled, size); !text.empty()) listener(Note{text});
  if (SizeToJson(settled) != SizeToJson(WithSize(known, size, {machine.is_gpu}))) {
    listener(Note{
        fmt::format("less than usual, for {:.1f} GB of the GPU's memory are free", Gigabytes(machine.free_bytes))});
  }
  return settled;
}

/// Replaces lists of views in files by their content, so that the run can be continued without the files.
RunRequest WithListsRead(const RunRequest& request) {
  RunRequest read = request;
  read.options.split = WithListsRead(request.options.split);
  return read;
}

/// Meters of a unit, for poses that were found: from the user's --scale, or else from GPS.
std::optional<double> UnitOf(const Run& run, bool opened) {
  if (!run.options.frame.scale.empty()) return UnitMeters(run.scene, run.options.frame.scale, true);
  const std::optional<GpsScale> gps = UnitMetersByGps(run.scene);
  if (!gps) return std::nullopt;
  if (!opened) {
    run.listener(Note{fmt::format("a unit is {:.3g} m, within {:.1f} %, by the GPS positions of {} (--scale overrules)",
                                  gps->unit_meters, 100 * gps->error, Counted(gps->views, "photo"))});
  }
  return gps->unit_meters;
}

/// Updates the header of the splat when the length of a unit became known after training.
void RefreshUnit(const Run& run) {
  const fs::path ply = run.workspace.point_cloud();
  std::error_code ignored;
  if (!fs::exists(ply, ignored)) return;
  try {
    const GaussianPly splat = ReadIntactGaussianPly(ply);
    if (UnitMetersOf(splat.comments) == run.frame.unit_meters) return;
    WriteGaussianPly(ply, splat.gaussians, splat.sh_degree, WithUnit(splat.comments, run.frame.unit_meters),
                     splat.marks);
  } catch (const InputError&) {  // the stages make a damaged file again
  }
}

/// Frame of given poses. `run` and commands on a scene folder get equal frames for equal splits.
SceneFrame GivenFrame(const Scene& scene, const Split& split, const RunOptions& options, const Listener& listener) {
  SceneFrame frame = NormalFrame(scene, split.train);
  if (options.input.frame == FrameKind::kScene) {
    if (const std::string why = WhyUnitsDoNotFit(frame); !why.empty()) {
      listener(Warning{fmt::format("--set frame=scene: {}; leave the option out", why)});
    }
    frame = SceneFrame();
    frame.is_given = true;
  }
  frame.unit_meters = UnitMeters(scene, options.frame.scale, false);
  return frame;
}

/// Brings the scene into the run's frame. The length of a unit belongs to the scene as given, or as found and framed.
void EnterFrame(Run* run, bool opened) {
  const bool found = !run->photos.empty();
  run->frame = found ? FrameOf(run->scene, run->workspace.frame())
                     : GivenFrame(run->scene, run->split, run->options, opened ? Silent() : run->listener);
  if (!opened) WriteFrame(run->scene, run->frame, run->workspace.frame());
  ApplyFrame(run->frame, &run->scene);
  if (found) run->frame.unit_meters = UnitOf(*run, opened);
  if (!opened) RefreshUnit(*run);
}

/// Finds poses where there are none, splits, and settles the frame. `opened`: the run is only inspected.
void FindPosesAndSplit(Run* run, bool opened) {
  RunStage(run, "masks");
  if (!run->photos.empty()) RunStage(run, "register");
  run->split = SplitOfRun(*run);
  EnterFrame(run, opened);
  opened ? UseRefinedPoses(run) : TakeRefinedPoses(run);
}

void SaveSplit(const Run& run) {
  const nlohmann::json json = SplitToJson(run.scene, run.split);
  ReportSplit(json, run.listener);
  WriteFileAtomically(run.workspace.split(), json.dump(2) + "\n");
}

}  // namespace

PosedScene ReadPosedScene(const fs::path& root, const RunOptions& options, const Listener& listener) {
  Scene scene = Read(root, options, {}, listener);
  if (!scene.HasPoses()) {
    throw InputError("{}: these photos have no poses; run `oraclegs reconstruct` and name its workspace instead",
                     root.string());
  }
  Split split = SplitViews(scene, WithListsRead(options.split));
  const SceneFrame frame = GivenFrame(scene, split, options, listener);
  ApplyFrame(frame, &scene);
  return {std::move(scene), std::move(split), frame};
}

fs::path OneFolder(const RunRequest& request) {
  if (request.inputs.empty() || IsUsedInPlace(request.inputs)) {
    return request.inputs.empty() ? request.scene : request.inputs.front();
  }
  throw UsageError("{}: this command takes one scene folder; run `oraclegs reconstruct` for anything else",
                   request.inputs.front().string());
}

Run StartRun(const RunRequest& asked, const Listener& listener) {
  CheckRunOptions(asked.options);
  RunRequest request = WithListsRead(asked);
  const bool imports = !request.inputs.empty() && !IsUsedInPlace(request.inputs);
  RequireInputsOutside(request.out, request.inputs);
  if (imports) {
    CheckInputs(request.inputs);
    std::error_code ignored;
    for (const fs::path& input : request.inputs) {
      if (fs::is_directory(input, ignored)) RequireOutsideScene(request.out, input);
    }
    request.scene = WorkspacePaths(request.out).photos();
  } else {
    request.scene = OneFolder(request);
    RequireOutsideScene(request.out, request.scene);
    request.inputs.clear();
  }
  const fs::path& proposals = request.options.propose.proposal_folder;
  if (!proposals.empty()) RequireApart(request.out, proposals);
  Scene scene;
  const auto read = [&] {
    scene = Read(request.scene, request.options, WorkspacePaths(request.out).faces(), listener);
    if (!imports) RequireOutsideScene(request.out, scene, request.options.input.images);
    CheckScale(scene, request.options.frame.scale);
  };
  if (!imports) read();
  const bool has_poses = scene.HasPoses();
  if (has_poses && request.options.input.poses == PoseSource::kVggt) {
    listener(Note{"--poses vggt: the scene has poses, which are used"});
  }
  // Missing files that options ask for are an error before anything is written.
  const RunOptions options = WithNetworksAtHand(request.options, has_poses, listener);
  Plan plan = MakePlan(options, has_poses, SensorDepthOf(scene));
  if (plan.needs_depth && plan.depth.prior == DepthPrior::kSensor) CheckSensorFiles(scene);
  const nlohmann::json saved_size = SavedSize(request);
  const auto settle = [&] {
    RunOptions settled = SettleSize(options, scene, plan.device, saved_size, listener);
    RequireNetworkNeeds(settled, plan, SizeOf(scene, options.split),
                        request.overwrite ? nlohmann::json::object() : ReadStageRecords(request.out));
    return settled;
  };
  if (imports) RequireSameFrames(request, saved_size);
  std::optional<RunOptions> settled;
  if (!imports) settled = settle();
  Workspace workspace = Workspace::Claim(request.out, request.scene, options, request.overwrite,
                                         {settled ? SizeToJson(*settled) : saved_size, request.inputs, true});
  if (imports) {
    ImportPhotos(request.inputs, SettleFrames(options, saved_size), workspace.photos(), listener);
    read();
    settled = settle();
    workspace.SaveSize(SizeToJson(*settled));
  }
  CutSpheres(scene, workspace.faces(), listener);
  TakeSize(*settled, &plan);
  Run run{*settled, request.version, std::move(plan), std::move(workspace), std::move(scene), {}, listener, ""};
  run.workspace.DropDamagedRecords(listener);
  run.stages = &Stages(), run.proposer_rows = &ProposerRows();
  run.start_iterations = ReadSavedRun(request.out).start_iterations;
  const auto live = std::make_shared<Live>(run.workspace, listener, ShowDocument);
  run.observer = live;
  run.listener = run.workspace.Watching(live->AsListener());
  if (request.on_claimed) request.on_claimed();
  Guarded(live.get(), [&] {
    run.photos = PhotosFingerprint(run.scene, &run.files);
    CheckRunPhotos(&run);
    KeepNeededPhotos(&run, run.listener);
    if (request.estimates) AnnounceStages(&run);
    if (!run.photos.empty()) live->Show(&run, kPhotosRead);
    FindPosesAndSplit(&run, false);
    SaveSplit(run);
  });
  return run;
}

Run OpenRun(const RunRequest& asked, const Listener& listener) {
  CheckRunOptions(asked.options);
  const RunRequest request = WithListsRead(asked);
  const SavedRun saved = ReadSavedRun(request.out);
  const std::string difference = DescribeDifference(saved.options, request.options, saved.size);
  if (!difference.empty()) {
    throw InputError("{}: was run with other options ({}); leave them out", request.out.string(), difference);
  }
  Scene scene = Read(saved.scene, request.options, WorkspacePaths(request.out).faces(), listener);
  Workspace workspace = Workspace::Open(request.out);
  CutSpheres(scene, workspace.faces(), listener);
  Plan plan = MakePlanToEvaluate(request.options);
  if (!scene.HasPoses()) plan.poses = PoseNetworkOf(request.options, workspace);
  const RunOptions settled = SettleSize(request.options, scene, plan.device, saved.size, Silent());
  plan.image = settled.image.Settled();
  Run run{settled, request.version, std::move(plan), std::move(workspace), std::move(scene), {}, listener, ""};
  run.stages = &Stages(), run.proposer_rows = &ProposerRows();
  run.start_iterations = saved.start_iterations;
  run.photos = PhotosFingerprint(run.scene, &run.files);
  LeaveOutUnreadablePhotos(&run);
  KeepNeededPhotos(&run, Silent());
  FindPosesAndSplit(&run, true);
  SaveSplit(run);
  return run;
}

}  // namespace oraclegs
