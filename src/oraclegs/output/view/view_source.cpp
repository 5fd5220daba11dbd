#include "oraclegs/output/view/view_source.h"

#include <nlohmann/json.hpp>

#include "oraclegs/core/error.h"
#include "oraclegs/core/folder_lock.h"
#include "oraclegs/formats/splat_file.h"
#include "oraclegs/web/site.h"
#include "oraclegs/workspace/stage_records.h"
#include "oraclegs/workspace/workspace.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr const char* kNewReport = "the command that made this run, given again, writes a new one";

/// True when there is a report of a run that has ended. Warns of a damaged one, or one without its splat.
bool HasReport(const fs::path& workspace, const Listener& listener) {
  const fs::path file = workspace / "report" / "run.json";
  std::error_code ignored;
  if (!fs::exists(file, ignored)) return false;
  Site site(workspace);
  const auto document = site.Document();
  if (!document) {
    listener(Warning{fmt::format("{}: is damaged; {}", file.string(), kNewReport)});
    return false;
  }
  const nlohmann::json json = nlohmann::json::parse(document->json);
  if (json.value("finished", nlohmann::json()) != true) return false;
  const nlohmann::json splat = json.value("splat", nlohmann::json());
  const nlohmann::json url = splat.is_object() ? splat.value("url", nlohmann::json()) : nlohmann::json();
  if (url.is_string() && !site.File(url.get<std::string>())) {
    listener(Warning{fmt::format("{}: is missing; {}", (workspace / url.get<std::string>()).string(), kNewReport)});
    return false;
  }
  return true;
}

/// State of the run that its last writer recorded; "" without one.
std::string StateOf(const fs::path& workspace) {
  const auto live = Site(workspace).Live();
  if (!live) return "";
  const nlohmann::json state = nlohmann::json::parse(live->json).value("state", nlohmann::json());
  return state.is_string() ? state.get<std::string>() : "";
}

}  // namespace

ViewSource::ViewSource(const fs::path& input, const Listener& listener) {
  std::error_code ignored;
  if (!fs::exists(input, ignored)) {
    throw InputError("{}: does not exist; name a workspace or a splat file", input.string());
  }
  if (!fs::is_directory(input, ignored) || IsSplatFolder(input)) {
    ShowFile(input, listener);
    return;
  }
  if (!IsWorkspace(input)) {
    throw InputError("{}: holds no run of oraclegs; name the workspace of a run (its -o), or a splat file",
                     input.string());
  }
  ReadSavedRun(input);  // throws when it is damaged or of another version
  ShowWorkspace(input, listener);
}

void ViewSource::ShowWorkspace(const fs::path& workspace, const Listener& listener) {
  const WorkspacePaths paths(workspace);
  std::error_code ignored;
  root_ = workspace;
  if (IsFolderLocked(paths.live())) {
    what_ = "a run that goes on";
  } else if (HasReport(workspace, listener)) {
    const std::string unfinished = UnfinishedSplat(workspace);
    what_ = unfinished.empty() ? "a finished run" : fmt::format("a run that was stopped: its {}", unfinished);
  } else if (fs::exists(paths.point_cloud(), ignored)) {
    listener(
        Note{fmt::format("{}: has no report; its splat alone is shown. `oraclegs reconstruct` with the run's own "
                         "options makes one without training again",
                         workspace.string())});
    ShowFile(paths.point_cloud(), listener);
  } else {
    const std::string state = StateOf(workspace);
    what_ = state.empty() ? "a workspace without a splat" : fmt::format("a run without a splat ({})", state);
    listener(Note{fmt::format("{}: holds no trained splat yet; the page shows the run as soon as one trains here",
                              workspace.string())});
  }
}

void ViewSource::ShowFile(const fs::path& file, const Listener& listener) {
  temporary_.emplace();
  WriteSplatSite(file, temporary_->path(), listener);
  root_ = temporary_->path();
  what_ = file.string();
}

}  // namespace oraclegs
