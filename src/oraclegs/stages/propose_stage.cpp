#include "oraclegs/stages/propose_stage.h"

#include <algorithm>

#include "oraclegs/core/function_ref.h"
#include "oraclegs/core/memory.h"
#include "oraclegs/image/png.h"
#include "oraclegs/propose/generator.h"
#include "oraclegs/propose/proposal_files.h"
#include "oraclegs/propose/trajectory.h"
#include "oraclegs/stages/proposers.h"
#include "oraclegs/stages/proxy_models.h"
#include "oraclegs/stages/seva_stage.h"
#include "oraclegs/workspace/non_commercial.h"
#include "oraclegs/workspace/part_store.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr size_t kTargetsTogether = 8;    // targets that are proposed together
constexpr uint64_t kKeptMemoryShare = 4;  // candidates are kept in one part in so many of the free memory

/// The files of --proposal-folder, and of the confidence beside synthetic_N.
std::vector<fs::path> FolderFiles(fs::path folder) {
  if (!folder.has_filename()) folder = folder.parent_path();
  std::vector<fs::path> files;
  const fs::path maps = folder.parent_path() / (folder.filename().string() + "_attention_maps");
  for (const fs::path& dir : {folder, maps}) {
    std::error_code ignored;
    for (const auto& entry : fs::recursive_directory_iterator(dir, ignored)) {
      if (entry.is_regular_file(ignored)) files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// Names of the split; names, intrinsics and poses of all views.
void AddPoses(const Run& run, Fingerprint* key) {
  for (const std::vector<int>* part : {&run.split.train, &run.split.test}) {
    for (const int view : *part) key->Add(run.scene.views[static_cast<size_t>(view)].name);
    key->Add("|");
  }
  for (const SceneView& view : run.scene.views) {
    key->Add(view.name).Add(view.intrinsics.width).Add(view.intrinsics.height);
    for (const double value : view.intrinsics.params) key->Add(value);
    for (const double value : view.cam_from_world->matrix().reshaped()) key->Add(value);
  }
}

void AddProposeKey(Run* run, Fingerprint* key) {
  const RunOptions& options = run->options;
  key->Add(run->plan.proposes);  // a folder may be all there is
  key->Add(OptionsToJson(options.propose).dump()).Add(OptionsToJson(options.trajectory).dump());
  key->Add(static_cast<double>(options.start.seed));  // of the poses
  if (run->plan.Uses(options, ProposerChoice::kSeva)) key->Add(SevaKey(options.seva));
  key->Add(OptionsToJson(options.image).dump());
  key->Add(ViewsFingerprint(run->scene, run->split.train, options.image, &run->files));
  AddPoses(*run, key);
  if (options.propose.proposal_folder.empty()) return;
  for (const fs::path& file : FolderFiles(options.propose.proposal_folder)) key->Add(file.string()).AddFile(file);
}

std::vector<Target> TargetsOf(const Run& run, const std::vector<int>& views) {
  std::vector<Target> targets;
  const std::vector<Camera> cameras = WorkingCameras(run.scene, views, run.options.image);
  for (size_t i = 0; i < views.size(); ++i) {
    targets.push_back({run.scene.views[static_cast<size_t>(views[i])].name, cameras[i]});
  }
  return targets;
}

FolderProposals ReadFolder(const Run& run, const LoadedView& view) {
  std::vector<int> no_test = SpareViews(run);
  no_test.insert(no_test.end(), run.split.train.begin(), run.split.train.end());
  return ReadProposalFolder(
      run.options.propose.proposal_folder,
      {WorkingCameras(run.scene, run.split.train, run.options.image), TargetsOf(run, run.split.test),
       TargetsOf(run, no_test), view.camera.width, view.camera.height, BackgroundColor(run.options.image.background),
       RunFromScene(run.frame)},
      run.listener);
}

/// Whether something is asked that needs no depth: what it makes of places that the photos hardly show, the oracle
/// classifies.
bool AsksGenerator(const Run& run) {
  return run.plan.Uses(run.options, ProposerChoice::kSeva) || run.plan.Uses(run.options, ProposerChoice::kCommand);
}

std::vector<Target> OwnTargets(const Run& run, const Geometry& geometry) {
  TrajectoryRequest request;
  request.train = WorkingCameras(run.scene, run.split.train, run.options.image);
  request.test = WorkingCameras(run.scene, run.split.test, run.options.image);
  request.spare = TargetsOf(run, SpareViews(run));
  request.maps = &geometry.maps;
  request.points = &geometry.points;
  request.seed = run.options.start.seed;
  request.sees_anything = AsksGenerator(run);
  TrajectoryOptions trajectory = run.options.trajectory;
  if (trajectory.proposals.is_auto() && ProxiesAlonePropose(run)) trajectory.proposals = kProxyProposals;
  return ChooseTargets(request, trajectory, run.listener);
}

/// What is proposed where. Deterministic: that of an earlier run is found again.
bool LoadPropose(Run* run) {
  StageResults& known = *run->results;
  const TrainingViews& training = ViewsOf(run);
  known.targets.clear(), known.folder = {}, known.proposers = nullptr;
  if (!run->options.propose.proposal_folder.empty()) known.folder = ReadFolder(*run, training.views.front());
  if (!run->plan.proposes) return true;
  if (AsksGenerator(*run) || CanPropose(training, known.geometry)) {
    known.targets = OwnTargets(*run, known.geometry);
  } else {
    run->listener(Warning{fmt::format(
        "no views are proposed: {} views with {} dense points; {} and {} are needed (--proposers none keeps silent)",
        training.views.size(), known.geometry.points.size(), kMinViewsToPropose, kMinPointsToPropose)});
  }
  // Both may be named after the same views.
  for (Proposal& p : known.folder.proposals) p.name = known.targets.empty() ? p.name : "folder_" + p.name;
  return true;
}

/// Names of the candidates' images, relative to the workspace.
std::vector<std::string> FilesOf(const std::vector<Proposal>& candidates) {
  std::vector<std::string> files;
  for (const Proposal& p : candidates) files.push_back(fmt::format("proposals/{}/{}.png", p.source, p.name));
  return files;
}

/// Writes them to `folder`, but those that the workspace has: what was generated.
void WriteImages(const Run& run, const fs::path& folder, const std::vector<Proposal>& candidates) {
  const std::vector<std::string> files = FilesOf(candidates);
  for (size_t c = 0; c < candidates.size(); ++c) {
    if (!fs::exists(run.workspace.root() / files[c])) WritePng(folder / files[c], ToImage8(candidates[c].rgb));
  }
}

/// Candidates of some targets, a few at a time, which `take` gets.
void AskFor(Run* run, const std::vector<size_t>& numbers,
            FunctionRef<void(size_t target, std::vector<Proposal> candidates)> take) {
  const Proposers& proposers = ProposersOf(run);
  for (size_t first = 0; first < numbers.size(); first += kTargetsTogether) {
    const size_t end = std::min(first + kTargetsTogether, numbers.size());
    std::vector<Target> chunk;
    for (size_t i = first; i < end; ++i) chunk.push_back(run->results->targets[numbers[i]]);
    std::vector<std::vector<Proposal>> of_chunk = proposers.Ask(chunk);
    for (size_t i = first; i < end; ++i) take(numbers[i], std::move(of_chunk[i - first]));
    run->listener(StepDone{"propose", static_cast<int64_t>(end), static_cast<int64_t>(numbers.size()), "views", ""});
  }
}

/// Of a part: what another process writes of its images. Another program's, or a damaged one, is none.
bool IsRecord(const nlohmann::json& part) {
  const nlohmann::json images = part.value("images", nlohmann::json());
  return images.is_array() &&
         std::all_of(images.begin(), images.end(), [](const nlohmann::json& name) { return name.is_string(); });
}

/// Images of all candidates, for the user to look at; the candidates are kept, but those that other processes made.
std::vector<std::string> WriteCandidates(Run* run, const PartStore& parts) {
  StageResults& known = *run->results;
  known.candidates = CandidateStore(AvailableMemory() / kKeptMemoryShare);
  std::vector<std::vector<std::string>> files(known.targets.size());
  std::vector<size_t> missing;
  for (size_t t = 0; t < known.targets.size(); ++t) {
    const auto part = parts.Take(t);
    if (part && IsRecord(*part)) {
      files[t] = part->at("images").get<std::vector<std::string>>();
    } else {
      missing.push_back(t);
    }
  }
  if (!missing.empty()) {
    AskFor(run, missing, [&](size_t t, std::vector<Proposal> candidates) {
      files[t] = FilesOf(candidates);
      WriteImages(*run, run->workspace.root(), candidates);
      known.candidates.Keep(known.targets[t].name, std::move(candidates));
    });
  }
  std::vector<std::string> all;
  for (const auto& of_one : files) all.insert(all.end(), of_one.begin(), of_one.end());
  return all;
}

void UndoPropose(Run* run, const nlohmann::json&) {
  for (const char* old : {"warp", "splat", "transforms.json"}) {
    std::error_code ignored;
    fs::remove_all(run->workspace.proposals() / old, ignored);
  }
  RemoveGenerated(run->workspace.proposals());
  RemoveGeneratorFiles(run->workspace.proposals());
}

/// Has the command of --generator generate all targets.
void AskGenerator(Run* run) {
  const fs::path proposals = run->workspace.proposals();
  const std::vector<Target>& targets = run->results->targets;
  WriteGeneratorRequest({proposals / "generator"}, targets, ViewsOf(run).views, ProposersOf(run).warper(),
                        RunFromScene(run->frame).Inverse());
  RunGenerator({run->options.propose.generator, run->options.generator_limits.generator_timeout, proposals}, targets,
               run->listener);
}

SevaRequest SevaRequestOf(Run* run, const std::string& key) {
  return {ViewsOf(run).views, run->results->targets,      key,
          run->options.seva,  run->workspace.proposals(), run->plan.device};
}

// What other processes can do beforehand: the chunks of Stable Virtual Camera that need photos alone, those that also
// need frames of the first ones, and the images of all candidates.
enum ProposeRound { kFirstChunks, kLaterChunks, kImages };

void MakeProposeShare(Run* run, const StageShare& share) {
  LoadPropose(run);
  const std::vector<Target>& targets = run->results->targets;
  if (share.round != kImages) return GenerateChunks(SevaRequestOf(run, share.key), share.share, run->listener);
  const PartStore parts(run->workspace, "propose", share.key);
  std::vector<size_t> mine;
  for (size_t t = 0; t < targets.size(); ++t) {
    if (share.share.Has(t) && !parts.Has(t)) mine.push_back(t);
  }
  AskFor(run, mine, [&](size_t t, const std::vector<Proposal>& candidates) {
    parts.Make(t, [&](const fs::path& folder) {
      WriteImages(*run, folder, candidates);
      return nlohmann::json{{"images", FilesOf(candidates)}};
    });
  });
}

std::optional<nlohmann::json> MakePropose(Run* run, const std::string& key) {
  LoadPropose(run);
  const StageResults& known = *run->results;
  if (known.targets.empty() && run->options.propose.proposal_folder.empty() && !AsksGenerator(*run) &&
      !CanPropose(ViewsOf(run), known.geometry)) {
    return std::nullopt;
  }
  const bool generates = !known.targets.empty() && run->options.propose.Uses(ProposerChoice::kSeva);
  if (generates) {
    for (const int round : {kFirstChunks, kLaterChunks})
      SpreadParts(run, {"propose", key, round, known.targets.size()});
    GenerateViews(SevaRequestOf(run, key), run->listener);
  }
  if (!known.targets.empty() && run->options.propose.Uses(ProposerChoice::kCommand)) AskGenerator(run);
  std::vector<std::string> files;
  if (!known.targets.empty()) {
    SpreadParts(run, {"propose", key, kImages, known.targets.size()});
    files = WriteCandidates(run, PartStore(run->workspace, "propose", key));
    WriteTargets(run->workspace.proposals(), known.targets, RunFromScene(run->frame).Inverse());
    files.emplace_back("proposals/transforms.json");
  }
  nlohmann::json record = {
      {"targets", known.targets.size()}, {"folder", known.folder.proposals.size()}, {"files", std::move(files)}};
  if (generates) NoteNonCommercial(kSevaName, &record);
  RemoveChunks(run->workspace.proposals());
  return record;
}

}  // namespace

std::vector<int> SpareViews(const Run& run) {
  std::vector<int> spare;
  for (int v = 0; v < static_cast<int>(run.scene.views.size()); ++v) {
    const auto is_in = [v](const std::vector<int>& part) {
      return std::find(part.begin(), part.end(), v) != part.end();
    };
    const bool tests = run.scene.views[static_cast<size_t>(v)].role == DeclaredRole::kTest;  // though not in this split
    if (!tests && !is_in(run.split.train) && !is_in(run.split.test)) spare.push_back(v);
  }
  return spare;
}

StageWork ProposeStage() {
  return {.wanted = [](const Run& run) { return run.plan.has_proposals; },
          .own = AddProposeKey,
          .undo = UndoPropose,
          .make = MakePropose,
          .make_share = MakeProposeShare,
          .load = LoadPropose};
}

}  // namespace oraclegs
