#include "oraclegs/app/project_state.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <utility>

#include "oraclegs/app/json_parts.h"
#include "oraclegs/core/folder_lock.h"
#include "oraclegs/core/text.h"
#include "oraclegs/core/unique_json.h"
#include "oraclegs/web/site.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

/// The end of a text file, as lines.
std::vector<std::string> TailOf(const fs::path& file) {
  constexpr std::streamoff kBytes = 16 << 10;
  std::ifstream in(file, std::ios::binary | std::ios::ate);
  if (!in) return {};
  const std::streamoff size = in.tellg();
  in.seekg(std::max<std::streamoff>(0, size - kBytes));
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(OneLine(line));
  if (size > kBytes && !lines.empty()) lines.erase(lines.begin());  // it begins in the middle
  return lines;
}

/// The error that the last start ended with; empty without one.
std::string ErrorOfLog(const ProjectPaths& paths) {
  constexpr std::string_view kError = "error: ";
  const std::vector<std::string> lines = TailOf(paths.log());
  for (auto line = lines.rbegin(); line != lines.rend(); ++line) {
    if (line->starts_with(kError)) return line->substr(kError.size());
  }
  return "";
}

nlohmann::json LiveOf(const Project& project) {
  Site site(project.splat());
  const std::optional<SiteDocument> live = site.Live();
  return live ? ParseJsonOrDiscard(live->json) : nlohmann::json();
}

/// A message for people who see a page and type no command.
std::string ForThePage(std::string message) {
  constexpr std::string_view kCommand = "run the same command again", kButton = "start it again here";
  const size_t at = message.find(kCommand);
  if (at != std::string::npos) message.replace(at, kCommand.size(), kButton);
  return message;
}

/// State of a run that nobody writes, by its files.
ProjectState StateAtRest(const Project& project, nlohmann::json live) {
  const std::string state = TextIn(live, "state"), message = OneLine(TextIn(live, "message"));
  const std::string error = ErrorOfLog(project.paths);
  ProjectState at_rest{ProjectPhase::kNew, message, std::move(live)};
  if (state == "finished") {
    at_rest.phase = ProjectPhase::kFinished;
    at_rest.message = error;  // of a start that came no further than its input
  } else if (state == "failed") {
    at_rest.phase = ProjectPhase::kFailed;
    if (!error.empty()) at_rest.message = error;
  } else if (!state.empty()) {
    at_rest.phase = ProjectPhase::kStopped;
    if (!error.empty()) at_rest = {ProjectPhase::kFailed, error, std::move(at_rest.live)};
  } else if (project.record.started) {
    at_rest.phase = error.empty() ? ProjectPhase::kStopped : ProjectPhase::kFailed;
    at_rest.message = error;
  }
  return at_rest;
}

}  // namespace

const char* PhaseWord(ProjectPhase phase) {
  switch (phase) {
    case ProjectPhase::kNew:
      return "new";
    case ProjectPhase::kWaiting:
      return "waiting";
    case ProjectPhase::kRunning:
      return "running";
    case ProjectPhase::kPaused:
      return "paused";
    case ProjectPhase::kStopped:
      return "stopped";
    case ProjectPhase::kFailed:
      return "failed";
    case ProjectPhase::kFinished:
      return "finished";
    case ProjectPhase::kElsewhere:
      return "elsewhere";
  }
  return "new";
}

ProjectState StateOf(const Project& project) {
  nlohmann::json live = LiveOf(project);
  const auto is = [&](ProjectPhase phase) { return ProjectState{phase, "", std::move(live)}; };
  switch (StateOf(project.record.process)) {
    case ProgramState::kRuns:
      return is(ProjectPhase::kRunning);
    case ProgramState::kPaused:
      return is(ProjectPhase::kPaused);
    case ProgramState::kGone:
      break;
  }
  if (IsFolderLocked(project.splat())) return is(ProjectPhase::kElsewhere);
  if (!project.problem.empty()) return {ProjectPhase::kFailed, project.problem, std::move(live)};
  if (project.record.queued > 0) return is(ProjectPhase::kWaiting);
  if (!project.is_foreign) {
    ProjectState at_rest = StateAtRest(project, std::move(live));
    at_rest.message = ForThePage(std::move(at_rest.message));
    return at_rest;
  }
  const bool finished = fs::exists(project.splat() / "point_cloud.ply");
  return is(finished ? ProjectPhase::kFinished : ProjectPhase::kStopped);
}

bool IsAtRest(ProjectPhase phase) {
  return phase == ProjectPhase::kNew || phase == ProjectPhase::kStopped || phase == ProjectPhase::kFailed ||
         phase == ProjectPhase::kFinished;
}

std::vector<std::string> LastLines(const ProjectPaths& paths, size_t lines) {
  std::vector<std::string> all = TailOf(paths.log());
  if (all.size() > lines) all.erase(all.begin(), all.end() - static_cast<ptrdiff_t>(lines));
  return all;
}

std::string StageInWords(const std::string& stage) {
  static constexpr std::pair<const char*, const char*> kWords[] = {{"import", "Copying the photos"},
                                                                   {"check", "Looking at the photos"},
                                                                   {"masks", "Masking the photos"},
                                                                   {"register", "Finding where each photo was taken"},
                                                                   {"sfm", "Finding points that photos share"},
                                                                   {"poses", "Checking where each photo was taken"},
                                                                   {"depth", "Measuring how far everything is"},
                                                                   {"proxies", "Making drafts"},
                                                                   {"propose", "Inventing views between the photos"},
                                                                   {"validate", "Checking what was invented"},
                                                                   {"train", "Making the splat"},
                                                                   {"evaluate", "Measuring the splat"},
                                                                   {"report", "Writing the report"}};
  for (const auto& [name, words] : kWords) {
    if (stage == name) return words;
  }
  return stage;
}

}  // namespace oraclegs
