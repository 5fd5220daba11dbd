#include "oraclegs/pipeline/stages/propose_stage.h"

#include <algorithm>

#include "oraclegs/pipeline/workspace/fingerprint.h"
#include "oraclegs/pipeline/workspace/non_commercial.h"
#include "oraclegs/pipeline/stages/proxy_models.h"
#include "oraclegs/propose/proposal_files.h"
#include "oraclegs/propose/trajectory.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr double kProposeVersion = 2;   // raised when the same inputs give other proposals
constexpr size_t kChunk = 8;            // targets whose pictures are held at once
constexpr size_t kFewestPoints = 1000;  // dense points without which there is nothing to carry to a new view
constexpr size_t kFewestPhotographs = 3;

/// Of the quick models: other poses are no reason to train them again.
std::string OpinionKey(const Run& run, const Geometry& geometry, const TrainOptions& decided) {
  Fingerprint print;
  print.Add(kProposeVersion).Add(geometry.key).Add(run.options.propose.opinions);
  print.Add(run.options.propose.opinion_finish).Add(run.options.train.iterations);  // whose share the finish is
  print.Add(OptionsToJson(run.options.start).dump()).Add(OptionsToJson(OpinionOptions(run.options, decided)).dump());
  print.Add(OptionsToJson(run.options.photo).dump());
  print.Add(ViewsFingerprint(run.scene, run.split.train, run.options.photo.downscale));
  return print.Hex();
}

std::string Key(const Run& run, const Geometry& geometry, const TrainOptions& decided) {
  Fingerprint print;
  print.Add(kProposeVersion).Add(geometry.key);
  print.Add(static_cast<double>(ProposesViews(run.options)));  // a folder may be all there is
  print.Add(OptionsToJson(run.options.propose).dump()).Add(OptionsToJson(run.options.trajectory).dump());
  print.Add(static_cast<double>(run.options.start.seed));  // of the poses
  // Nothing else of start or training reaches a warp.
  if (run.options.propose.Names("splat")) print.Add(OpinionKey(run, geometry, decided));
  if (run.options.propose.Names("seva") && ProposesViews(run.options)) print.Add(SevaKey(run.options));
  print.Add(OptionsToJson(run.options.photo).dump()).Add(ProposalInputs(run));
  print.Add(ViewsFingerprint(run.scene, run.split.train, run.options.photo.downscale));
  return print.Hex();
}

std::vector<Camera> CamerasOf(const Run& run, const std::vector<int>& views) {
  std::vector<Camera> cameras;
  for (const int v : views) {
    cameras.push_back(WorkingCamera(run.scene.views[static_cast<size_t>(v)], run.options.photo));
  }
  return cameras;
}

std::vector<Target> TargetsOf(const Run& run, const std::vector<int>& views) {
  std::vector<Target> targets;
  const std::vector<Camera> cameras = CamerasOf(run, views);
  for (size_t i = 0; i < views.size(); ++i) {
    targets.push_back({run.scene.views[static_cast<size_t>(views[i])].name, cameras[i]});
  }
  return targets;
}

FolderProposals ReadFolder(const Run& run, const LoadedView& photo) {
  std::vector<int> no_test = SpareViews(run);
  no_test.insert(no_test.end(), run.split.train.begin(), run.split.train.end());
  return ReadProposalFolder(run.options.propose.proposal_folder,
                            {CamerasOf(run, run.split.train), TargetsOf(run, run.split.test), TargetsOf(run, no_test),
                             photo.camera.width, photo.camera.height, BackgroundColor(run.options.photo.background)},
                            run.listener);
}

std::vector<Target> OwnTargets(const Run& run, const Geometry& geometry) {
  TrajectoryRequest request;
  request.train = CamerasOf(run, run.split.train);
  request.test = CamerasOf(run, run.split.test);
  request.spare = TargetsOf(run, SpareViews(run));
  request.maps = &geometry.maps;
  request.points = &geometry.points;
  request.seed = run.options.start.seed;
  return ChooseTargets(request, run.options.trajectory, run.listener);
}

bool CanPropose(const Run& run, const std::vector<LoadedView>& photos, const Geometry& geometry) {
  if (geometry.points.size() >= kFewestPoints && photos.size() >= kFewestPhotographs) return true;
  run.listener(
      Warning{fmt::format("no views are proposed: {} photographs with {} dense points; {} and {} are needed "
                          "(--proposers none keeps silent)",
                          photos.size(), geometry.points.size(), kFewestPhotographs, kFewestPoints)});
  return false;
}

/// Pictures of all candidates, to look at.
std::vector<std::string> WriteCandidates(const Run& run, const Proposers& proposers,
                                         const std::vector<Target>& targets) {
  std::vector<std::string> files;
  for (size_t first = 0; first < targets.size(); first += kChunk) {
    const std::vector<Target> chunk(targets.begin() + static_cast<int64_t>(first),
                                    targets.begin() + static_cast<int64_t>(std::min(first + kChunk, targets.size())));
    for (const auto& candidates : proposers.Ask(chunk, std::vector<int>(chunk.size(), -1))) {
      for (const Proposal& p : candidates) {
        files.push_back(fmt::format("proposals/{}/{}.png", p.source, p.name));
        const fs::path picture = run.workspace.root() / files.back();
        if (!fs::exists(picture)) WritePng(picture, ToImage8(p.rgb));  // what was generated is there
      }
    }
    run.listener(StepDone{"propose", static_cast<int64_t>(first + chunk.size()), static_cast<int64_t>(targets.size()),
                          "views", ""});
  }
  return files;
}

}  // namespace

std::vector<int> SpareViews(const Run& run) {
  std::vector<int> spare;
  for (int v = 0; v < static_cast<int>(run.scene.views.size()); ++v) {
    const auto is_in = [v](const std::vector<int>& part) {
      return std::find(part.begin(), part.end(), v) != part.end();
    };
    if (!is_in(run.split.train) && !is_in(run.split.test)) spare.push_back(v);
  }
  return spare;
}

std::string ProposalInputs(const Run& run) {
  fs::path folder = run.options.propose.proposal_folder;
  if (!ProposesViews(run.options) && folder.empty()) return "";
  Fingerprint print;
  for (const std::vector<int>* part : {&run.split.train, &run.split.test}) {
    for (const int view : *part) print.Add(run.scene.views[static_cast<size_t>(view)].name);
    print.Add("|");
  }
  for (const SceneView& view : run.scene.views) {
    print.Add(view.name).Add(view.lens.width).Add(view.lens.height);
    for (const double value : view.lens.params) print.Add(value);
    for (const double value : view.cam_from_world->matrix().reshaped()) print.Add(value);
  }
  if (folder.empty()) return print.Hex();
  if (!folder.has_filename()) folder = folder.parent_path();
  std::vector<fs::path> files;
  const fs::path maps = folder.parent_path() / (folder.filename().string() + "_attention_maps");  // beside synthetic_N
  for (const fs::path& dir : {folder, maps}) {
    std::error_code ignored;
    for (const auto& entry : fs::recursive_directory_iterator(dir, ignored)) {
      if (entry.is_regular_file(ignored)) files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) print.Add(file.string()).AddFile(file);
  return print.Hex();
}

bool ProposesViews(const RunOptions& options) {
  return options.propose.proposers != "none" && options.trajectory.proposals > 0 && options.train.schedule != "none";
}

ProposalPlan RunPropose(Run* run, const std::vector<LoadedView>& photos, const Geometry& geometry,
                        const TrainOptions& decided) {
  ProposalPlan plan;
  const bool own = ProposesViews(run->options) && CanPropose(*run, photos, geometry);
  const auto& folder = run->options.propose.proposal_folder;
  if (!own && folder.empty()) {
    run->workspace.MarkUndone("propose");
    return plan;
  }
  const StageClock clock("propose", run->listener);
  plan.key = Key(*run, geometry, decided);
  if (!folder.empty()) plan.folder = ReadFolder(*run, photos.front());
  if (own) plan.targets = OwnTargets(*run, geometry);
  // Both may be named after the same views.
  for (Proposal& p : plan.folder.proposals) p.name = plan.targets.empty() ? p.name : "folder_" + p.name;
  const bool cached = run->workspace.IsDone("propose", plan.key);
  if (!plan.targets.empty() && run->options.propose.Names("splat")) {
    plan.opinions = TrainOpinions(run, photos, geometry, OpinionOptions(run->options, decided),
                                  OpinionKey(*run, geometry, decided));
  }
  if (cached) {
    clock.Finish();
    return plan;
  }
  run->workspace.MarkUndone("propose");
  for (const char* old : {"warp", "splat", "transforms.json"}) {
    std::error_code ignored;
    fs::remove_all(run->workspace.proposals() / old, ignored);
  }
  RemoveGenerated(run->workspace.proposals());
  std::vector<std::string> files;
  const bool generates = !plan.targets.empty() && run->options.propose.Names("seva");
  if (generates) GenerateViews(*run, {photos, plan.targets, plan.key});
  if (!plan.targets.empty()) {
    files = WriteCandidates(*run, Proposers(*run, photos, geometry, plan.opinions), plan.targets);
    WriteTargets(run->workspace.proposals(), plan.targets);
    files.emplace_back("proposals/transforms.json");
  }
  const double seconds = clock.Finish();
  nlohmann::json record = {{"key", plan.key},
                           {"seconds", seconds},
                           {"targets", plan.targets.size()},
                           {"folder", plan.folder.proposals.size()},
                           {"opinions", plan.opinions.size()},
                           {"files", std::move(files)}};
  if (generates) NoteNonCommercial(kSevaName, &record);
  run->workspace.MarkDone("propose", record);
  RemoveChunks(run->workspace.proposals());
  return plan;
}

}  // namespace oraclegs
