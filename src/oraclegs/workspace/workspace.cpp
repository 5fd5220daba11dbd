#include "oraclegs/workspace/workspace.h"

#include <algorithm>
#include <set>
#include <utility>

#include "oraclegs/core/atomic_file.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/text.h"
#include "oraclegs/scene/scene.h"
#include "oraclegs/workspace/stage_records.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

// All names that a run may leave at the top of its folder; --overwrite removes these and nothing else.
constexpr const char* kOwnNames[] = {"options.json",   "split.json",  "stages.json",
                                     "metrics.json",   "sfm",         "point_cloud.ply",
                                     "checkpoints",    "renders",     "depth",
                                     "exposures.json", "proposals",   "confidence",
                                     "oracle.json",    "live",        "train.csv",
                                     "report",         "report.html", "photos",
                                     "faces",          "masks",       "photo_checks.json",
                                     "frame.json"};

// The programs of a run that was killed end within moments.
constexpr std::chrono::milliseconds kPatience(2000);

fs::path Canonical(const fs::path& path) {
  std::error_code ignored;
  fs::path out = fs::weakly_canonical(fs::absolute(path, ignored), ignored);
  return out.has_filename() ? out : out.parent_path();  // "dir/" and "dir" are one folder
}

// A killed run can leave its lock and a temporary file before its first real file; these two do not count.
bool HoldsAnything(const fs::path& dir) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(dir, error)) {
    if (!IsTemporaryName(entry.path()) && entry.path().filename() != kFolderLockName) return true;
  }
  return false;
}

void RemoveRun(const fs::path& dir) {
  // options.json is removed last: while it exists, the folder is recognized as ours.
  for (const char* name : kOwnNames) {
    if (std::string_view(name) == "options.json") continue;
    std::error_code error;
    fs::remove_all(dir / name, error);
    if (error) throw RunError("{}: cannot be removed: {}", (dir / name).string(), SystemReason(error));
  }
  fs::remove(dir / "options.json");
}

/// Path as text for JSON: bytes that are not UTF-8 are replaced.
std::string JsonText(const fs::path& path) {
  const auto replace = nlohmann::json::error_handler_t::replace;
  return nlohmann::json::parse(nlohmann::json(path.string()).dump(-1, ' ', false, replace)).get<std::string>();
}

/// True when training has finished and its last checkpoint exists, so that it can be continued.
bool HasTrained(const WorkspacePaths& paths) {
  return ReadStageRecords(paths.root()).contains("train") && HoldsAnything(paths.checkpoints());
}

/// --iterations that the run in `dir` was started with, when it is continued with more; 0 = it is not.
int64_t StartIterations(const fs::path& dir, const RunOptions& now) {
  const SavedRun saved = ReadSavedRun(dir);
  if (saved.start_iterations > 0) return saved.start_iterations;
  return AsksForMoreIterations(saved, now) ? IterationsOf(saved) : 0;
}

/// Text for messages: the scene's folder, or the imported paths.
std::string SourceText(const std::string& scene, const std::vector<std::string>& inputs) {
  std::vector<std::string> names;
  for (const std::string& input : inputs) names.push_back(OneLine(input));
  return inputs.empty() ? scene : SomeNames(names);
}

std::vector<std::string> JsonTexts(const std::vector<fs::path>& paths) {
  std::vector<std::string> texts;
  for (const fs::path& path : paths) texts.push_back(JsonText(Canonical(path)));
  return texts;
}

void RefuseForeignFolder(const fs::path& dir, const fs::path& scene, const std::vector<std::string>& inputs,
                         const RunOptions& options, bool may_train_on) {
  if (!IsWorkspace(dir)) {
    if (HoldsAnything(dir)) {
      throw InputError("{}: is not empty and holds no run of oraclegs; choose a new or empty folder with -o",
                       dir.string());
    }
    return;
  }
  const SavedRun saved = ReadSavedRun(dir);
  std::error_code ignored;
  const bool is_other = saved.inputs != inputs || (inputs.empty() && saved.scene != JsonText(scene));
  if (is_other && (HasResults(WorkspacePaths(dir)) || fs::exists(WorkspacePaths(dir).sfm(), ignored))) {
    throw InputError(
        "{}: holds a run of another scene ({}, now is {}); choose another -o, or start anew with "
        "--overwrite",
        dir.string(), SourceText(saved.scene.string(), saved.inputs), SourceText(scene.string(), inputs));
  }
  const std::string difference = DescribeDifference(saved.options, options, saved.size);
  // Other options lose nothing while there is only structure from motion, which checks its own inputs.
  const bool goes_on = may_train_on && (AsksForHigherQuality(saved, options) ||
                                        (AsksForMoreIterations(saved, options) && HasTrained(WorkspacePaths(dir))));
  if (!difference.empty() && !goes_on && HasResults(WorkspacePaths(dir))) {
    throw InputError(
        "{}: holds a run with other options ({}); give the same options to continue it, choose another -o, "
        "or start anew with --overwrite",
        dir.string(), difference);
  }
}

void WriteJson(const fs::path& path, const nlohmann::json& json) {
  WriteFileAtomically(path, json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

void RequireOutside(const fs::path& dir, const fs::path& folder, const char* what) {
  const fs::path out = Canonical(dir), inside = Canonical(folder);
  const auto [end, rest] = std::mismatch(inside.begin(), inside.end(), out.begin(), out.end());
  if (end != inside.end()) return;
  throw InputError("{}: lies in {} {}, which is never written to; choose a folder outside it with -o", dir.string(),
                   what, folder.string());
}

/// Throws RunError when the folder was removed, even when only its files were: `rm -r` removes them first.
void RequireThere(const FolderLock& lock, const fs::path& dir) {
  std::error_code ignored;
  if (lock.IsStillThere() && fs::exists(WorkspacePaths(dir).options(), ignored)) return;
  throw RunError("{}: was removed or replaced while the run was working there; run the same command again",
                 dir.string());
}

}  // namespace

bool HasResults(const WorkspacePaths& paths) {
  std::error_code ignored;
  return (fs::exists(paths.point_cloud(), ignored) && UnfinishedSplat(paths.root()).empty()) ||
         fs::exists(paths.metrics(), ignored) ||
         (fs::is_directory(paths.checkpoints(), ignored) && HoldsAnything(paths.checkpoints()));
}

void RequireOutsideScene(const fs::path& dir, const fs::path& scene_root) {
  RequireOutside(dir, scene_root, "the scene folder");
}

void RequireOutsideScene(const fs::path& dir, const Scene& scene, const fs::path& images) {
  RequireOutsideScene(dir, scene.root);
  std::set<fs::path> folders;
  if (!images.empty()) folders.insert(scene.root / images);
  for (const SceneView& view : scene.views) {
    folders.insert((view.sphere ? view.sphere->image_path : view.image_path).parent_path());
  }
  for (const fs::path& folder : folders) RequireOutside(dir, folder, "the scene's image folder");
}

void RequireApart(const fs::path& dir, const fs::path& folder) {
  if (!IsUtf8(folder.string())) {
    throw InputError("{}: the name of the --proposal-folder is not valid UTF-8; rename it",
                     EscapeBytes(folder.string()));
  }
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored)) {
    throw InputError("{}: is no folder; name one that holds proposals with --proposal-folder", folder.string());
  }
  RequireOutside(dir, folder, "the proposal folder");
  const fs::path out = Canonical(dir), inside = Canonical(folder);
  const auto [end, rest] = std::mismatch(out.begin(), out.end(), inside.begin(), inside.end());
  if (end != out.end()) return;
  throw InputError("{}: lies in the workspace {}, whose files are written anew; move the proposals elsewhere",
                   folder.string(), dir.string());
}

Workspace::Workspace(const fs::path& dir) : WorkspacePaths(dir) {
  RequireWritableFolder(dir);
  lock_ = std::make_shared<const FolderLock>(dir, kPatience);
  if (lock_->state() == FolderLock::State::kHeldByAnother) {
    throw InputError("{}: another oraclegs is working there ({}); wait for it, or choose another -o", dir.string(),
                     lock_->holder());
  }
  RemoveLeftovers(dir);
}

void Workspace::RequireThere() const { oraclegs::RequireThere(*lock_, root()); }

Listener Workspace::Watching(Listener listener) const {
  return [lock = lock_, dir = root(), listener = std::move(listener)](const Event& event) {
    if (std::holds_alternative<StepDone>(event)) oraclegs::RequireThere(*lock, dir);
    listener(event);
  };
}

Workspace Workspace::Claim(const fs::path& dir, const fs::path& scene_root, const RunOptions& options, bool overwrite,
                           const RunDetails& details) {
  RequireOutsideScene(dir, scene_root);
  const fs::path scene = Canonical(scene_root);
  const std::vector<std::string> inputs = JsonTexts(details.imported);
  const bool start_anew = overwrite && IsWorkspace(dir);
  if (!start_anew) RefuseForeignFolder(dir, scene, inputs, options, details.may_train_on);
  Workspace workspace(dir);
  if (start_anew) {
    ReadSavedRun(dir);  // throws when the file is of another program
    RemoveRun(dir);
  }
  nlohmann::json json = {{"program", "oraclegs"},
                         {"format", kRunFormat},
                         {"scene", JsonText(scene)},
                         {"options", RunOptionsToJson(options)},
                         {"size", details.size}};
  if (!inputs.empty()) json["inputs"] = inputs;
  if (IsWorkspace(dir) && HasResults(workspace)) {
    const SavedRun saved = ReadSavedRun(dir);
    if (AsksForHigherQuality(saved, options)) {
      workspace.MarkDone(kBestSoFar, {{"of", "splat of --quality " + QualityOf(saved)}});
      std::error_code error;
      fs::remove_all(workspace.checkpoints(), error);
      if (error) throw RunError("{}: cannot be removed: {}", workspace.checkpoints().string(), SystemReason(error));
    }
    if (const int64_t start = StartIterations(dir, options); start > 0) json["start_iterations"] = start;
  }
  WriteJson(workspace.options(), json);
  return workspace;
}

void Workspace::DropDamagedRecords(const Listener& listener) const {
  const StageRecords records = InspectStageRecords(root());
  if (!records.is_readable) {
    listener(Warning{fmt::format("{}: is damaged; all stages are made again", stages().string())});
  } else if (!records.damaged.empty()) {
    listener(Warning{fmt::format("{}: what it says of {} is damaged; that is made again", stages().string(),
                                 SomeNames(records.damaged))});
  } else {
    return;
  }
  WriteJson(stages(), records.by_stage);
}

void Workspace::SaveSize(const nlohmann::json& size) const {
  nlohmann::json json = ReadRunJson(options());
  json["size"] = size;
  WriteJson(options(), json);
}

Workspace Workspace::Open(const fs::path& dir) {
  ReadSavedRun(dir);
  return Workspace(dir);
}

nlohmann::json Workspace::Record(const std::string& stage) const {
  const nlohmann::json all = ReadStageRecords(root());
  return all.contains(stage) ? all[stage] : nullptr;
}

bool Workspace::IsDone(const std::string& stage, const std::string& key) const {
  const nlohmann::json record = Record(stage);
  if (!record.is_object() || record.value("key", nlohmann::json()) != key) return false;
  const nlohmann::json files = record.value("files", nlohmann::json::array());
  return std::all_of(files.begin(), files.end(), [&](const nlohmann::json& file) {
    std::error_code ignored;
    return file.is_string() && fs::exists(root() / file.get<std::string>(), ignored);
  });
}

void Workspace::MarkUndone(const std::string& stage) {
  nlohmann::json all = ReadStageRecords(root());
  if (all.erase(stage) > 0) WriteJson(stages(), all);
}

void Workspace::MarkDone(const std::string& stage, const nlohmann::json& record) {
  RequireThere();
  nlohmann::json all = ReadStageRecords(root());
  all[stage] = record;
  WriteJson(stages(), all);
}

}  // namespace oraclegs
