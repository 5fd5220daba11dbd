#include "oraclegs/stages/stage_works.h"

#include <algorithm>

#include "oraclegs/core/host.h"
#include "oraclegs/core/text.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/propose/proposal_files.h"
#include "oraclegs/propose/trajectory.h"
#include "oraclegs/stages/proposer_row.h"
#include "oraclegs/stages/stage_seconds.h"
#include "oraclegs/workspace/non_commercial.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr size_t kTargetsTogether = 8;             // targets that are proposed together
constexpr uint64_t kKeptMemoryShare = 4;           // candidates are kept in one part in so many of the free memory
constexpr uint64_t kMostKept = uint64_t{1} << 30;  // bytes; those of many large views are made again

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
  if (AreProposalsSeeded(options)) key->Add(static_cast<double>(options.start.seed));
  for (const ProposerRow& row : *run->proposer_rows) {
    if (row.own != nullptr && Asks(*run, row)) row.own(*run, key);
  }
  key->Add(OptionsToJson(options.image).dump());
  key->Add(ViewsKey(run, run->split.train, run->plan.image));
  AddPoses(*run, key);
  if (options.propose.proposal_folder.empty()) return;
  for (const fs::path& file : FolderFiles(options.propose.proposal_folder)) key->Add(file.string()).AddFile(file);
}

std::vector<Target> TargetsOf(const Run& run, const std::vector<int>& views) {
  std::vector<Target> targets;
  const std::vector<Camera> cameras = WorkingCameras(run.scene, views, run.plan.image);
  for (size_t i = 0; i < views.size(); ++i) {
    targets.push_back({run.scene.views[static_cast<size_t>(views[i])].name, cameras[i]});
  }
  return targets;
}

FolderProposals ReadFolder(const Run& run, const LoadedView& view) {
  std::vector<int> no_test = SpareViews(run);
  no_test.insert(no_test.end(), run.split.train.begin(), run.split.train.end());
  return ReadProposalFolder(run.options.propose.proposal_folder,
                            {WorkingCameras(run.scene, run.split.train, run.plan.image), TargetsOf(run, run.split.test),
                             TargetsOf(run, no_test), view.camera.width, view.camera.height,
                             BackgroundColor(run.plan.image.background), RunFromScene(run.frame)},
                            run.listener);
}

/// Gives the targets the size at which the run's generator works.
void TakeOwnSize(const Run& run, std::vector<Target>* targets) {
  for (const ProposerRow& row : *run.proposer_rows) {
    if (row.own_size == nullptr || !run.plan.Uses(run.options, row.word)) continue;
    for (Target& target : *targets) {
      const PixelSize size = row.own_size(run, {target.camera.width, target.camera.height});
      target.camera = Resized(target.camera, size.width, size.height);
    }
    return;
  }
}

std::vector<Target> OwnTargets(const Run& run, const Geometry& geometry) {
  const TargetPlan plan = TargetPlanOf(run, ProxiesAlonePropose(run));
  if (plan.count == 0) {
    run.listener(Note{fmt::format(
        "{} photos stand so close together that they leave little open: they train alone (--proposals N proposes all "
        "the same)",
        run.split.train.size())});
    return {};
  }
  TrajectoryRequest request;
  request.train = WorkingCameras(run.scene, run.split.train, run.plan.image);
  request.test = WorkingCameras(run.scene, run.split.test, run.plan.image);
  request.spare = TargetsOf(run, SpareViews(run));
  request.maps = &geometry.maps;
  request.points = &geometry.points;
  request.seed = run.options.start.seed;
  request.sees_anything = AsksGenerator(run);
  std::vector<Target> targets = ChooseTargets(request, plan, run.listener);
  if (run.options.propose.proposal_size == ProposalSize::kOwn) TakeOwnSize(run, &targets);
  return targets;
}

/// Chooses what is proposed where. Deterministic, so that the choice of an earlier run is found again.
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

/// Images of all candidates, but what was generated, for the user to look at; the candidates are kept. Their names,
/// relative to the workspace.
std::vector<std::string> WriteCandidates(Run* run) {
  StageResults& known = *run->results;
  known.candidates = CandidateStore(std::min(AvailableMemory() / kKeptMemoryShare, kMostKept));
  const Proposers& proposers = ProposersOf(run);
  const size_t count = known.targets.size();
  std::vector<std::string> files;
  for (size_t first = 0; first < count; first += kTargetsTogether) {
    const size_t end = std::min(first + kTargetsTogether, count);
    const auto begin = known.targets.begin();
    const std::vector<Target> chunk(begin + static_cast<int64_t>(first), begin + static_cast<int64_t>(end));
    std::vector<std::vector<Proposal>> candidates = proposers.Ask(chunk);
    for (size_t i = 0; i < chunk.size(); ++i) {
      for (const Proposal& p : candidates[i]) {
        files.push_back(fmt::format("proposals/{}/{}.png", p.source, p.name));
        const fs::path file = run->workspace.root() / files.back();
        if (!fs::exists(file)) WritePng(file, ToImage8(p.rgb));
      }
      known.candidates.Keep(chunk[i].name, std::move(candidates[i]));
    }
    run->listener(StepDone{"propose", static_cast<int64_t>(end), static_cast<int64_t>(count), "views", ""});
  }
  return files;
}

void UndoPropose(Run* run, const nlohmann::json&) {
  std::error_code ignored;
  fs::remove(run->workspace.proposals() / "transforms.json", ignored);
  for (const ProposerRow& row : *run->proposer_rows) {
    if (row.undo != nullptr) row.undo(run->workspace.proposals());
  }
}

std::optional<nlohmann::json> MakePropose(Run* run, const std::string& key) {
  LoadPropose(run);
  const StageResults& known = *run->results;
  const fs::path proposals = run->workspace.proposals();
  if (known.targets.empty() && run->options.propose.proposal_folder.empty() && !AsksGenerator(*run)) {
    return std::nullopt;
  }
  nlohmann::json record = {{"targets", known.targets.size()}, {"folder", known.folder.proposals.size()}};
  std::vector<std::string> files;
  if (!known.targets.empty()) {
    for (const ProposerRow& row : *run->proposer_rows) {
      if (!Asks(*run, row)) continue;
      if (row.prepare != nullptr) row.prepare(run, key);
      if (*row.non_commercial != '\0') NoteNonCommercial(row.non_commercial, &record);
    }
    files = WriteCandidates(run);
    WriteTargets(proposals, known.targets, RunFromScene(run->frame).Inverse());
    files.emplace_back("proposals/transforms.json");
  }
  record["files"] = std::move(files);
  for (const ProposerRow& row : *run->proposer_rows) {
    if (row.finish != nullptr) row.finish(proposals);
  }
  return record;
}

std::string ProposedText(const nlohmann::json& record) {
  std::string text = Counted(CountIn(record, "targets"), "view");
  if (CountIn(record, "folder") > 0) text += fmt::format(", {} from the folder", CountIn(record, "folder"));
  return text;
}

}  // namespace

bool AreProposalsSeeded(const RunOptions& options) {
  const Auto<Trajectory>& trajectory = options.trajectory.trajectory;
  return trajectory.is_auto() || trajectory.value() == Trajectory::kCoverage || options.propose.Uses(kProxiesWord);
}

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
          .load = LoadPropose,
          .summary = ProposedText,
          .seconds =
              [](const EstimateInput& input) {
                constexpr double kProposeOfPixel = 0.35e-6, kPropose = 1;
                return kPropose + kProposeOfPixel * CoveredPixels(input) * ProposalsOf(input);
              },
          .uses_network = AsksGenerator};
}

}  // namespace oraclegs
