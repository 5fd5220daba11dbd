#pragma once
// Documents that the page asks for again and again: the library, and one project.

#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "oraclegs/app/errands.h"
#include "oraclegs/app/project_state.h"
#include "oraclegs/app/run_queue.h"

namespace oraclegs {

/// A choice that the page offers.
struct AppChoice {
  std::string id, label;
};

/// Choices of a run.
struct AppChoices {
  std::vector<AppChoice> qualities, devices;  ///< the first device is the usual one
  std::string quality;                        ///< that is chosen at first
};

/// Pictures that runs name, looked up once for each version of a run's document. Safe to call from any thread.
class Pictures {
 public:
  /// Path of a render or photo below the workspace; empty where the run names none.
  std::string Of(const Project& project);

 private:
  struct Known {
    std::string version, path;
  };
  std::mutex mutex_;
  std::map<std::string, Known> known_;
};

/// All that documents are made of.
struct AppParts {
  const Library& library;
  const RunQueue& queue;
  Errands* errands;
  Pictures* pictures;
  const AppChoices& choices;
};

/// The document of the library: its folder, what can be chosen, and a summary of each project, newest first.
nlohmann::json LibraryDocument(const AppParts& parts);

/// The document of one project: its summary, files, checks, stages, edits and exports.
nlohmann::json ProjectDocument(const AppParts& parts, const Project& project);

}  // namespace oraclegs
