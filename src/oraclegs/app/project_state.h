#pragma once
// State of a project, as its files and processes show it.

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "oraclegs/app/library.h"

namespace oraclegs {

enum class ProjectPhase {
  kNew,      ///< photos are being collected
  kWaiting,  ///< others are before it
  kRunning,
  kPaused,
  kStopped,  ///< goes on from where it was
  kFailed,
  kFinished,
  kElsewhere  ///< another program writes its run
};

/// The word that the page knows.
const char* PhaseWord(ProjectPhase phase);

struct ProjectState {
  ProjectPhase phase = ProjectPhase::kNew;
  std::string message;  ///< why it failed or was stopped; empty otherwise
  nlohmann::json live;  ///< live/state.json of the run; null where there is none
};

/// Looks at the project's process, its locks and live/state.json.
ProjectState StateOf(const Project& project);

/// Whether photos may be added and removed, and a run be started.
bool IsAtRest(ProjectPhase phase);

/// The last lines that the run printed, at most `lines`, fit to be shown.
std::vector<std::string> LastLines(const ProjectPaths& paths, size_t lines);

/// A stage in words that need no knowledge of the program; the name itself for one that is not known.
std::string StageInWords(const std::string& stage);

}  // namespace oraclegs
