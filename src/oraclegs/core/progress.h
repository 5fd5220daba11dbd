#pragma once
// Events that a running stage reports. The library never prints: the terminal, the log file and a viewer listen.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <variant>
#include <vector>

namespace oraclegs {

/// The stages that a run will go through, in their order, and how long each is expected to take.
struct RunPlanned {
  struct Planned {
    std::string stage;
    double seconds = 0;  ///< 0 = nobody knows
  };
  std::vector<Planned> stages;
};

/// A stage of the pipeline ("sfm", "train", ...) begins.
struct StageStarted {
  std::string stage;
};

/// `done` of `total` steps are finished; the listener derives rate and time left.
struct StepDone {
  std::string stage;
  int64_t done = 0;
  int64_t total = 0;
  std::string unit;    ///< plural noun of what is counted: "iterations", "views"
  std::string detail;  ///< what else to show, e.g. "loss 0.0312, 45210 Gaussians"
};

struct StageFinished {
  std::string stage;
  double seconds = 0;
};

/// A stage's result is that of an earlier run; if it had to be read back, StageFinished came first.
struct StageKept {
  std::string stage;
};

/// A file that the user may want to open stands under its final name.
struct FileWritten {
  std::filesystem::path path;
};

/// Something the user should know and can act on; the run goes on.
struct Warning {
  std::string text;
};

/// Something worth a line in normal operation.
struct Note {
  std::string text;
};

using Event = std::variant<RunPlanned, StageStarted, StepDone, StageFinished, StageKept, FileWritten, Warning, Note>;

/// Receives events on the thread that runs the stage. Must not be empty when passed to the library; see Silent().
using Listener = std::function<void(const Event&)>;

/// A listener that drops everything.
inline Listener Silent() {
  return [](const Event&) {};
}

}  // namespace oraclegs
