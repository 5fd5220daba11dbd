#pragma once

#include <string>
#include <vector>

#include "oraclegs/core/progress.h"

namespace oraclegs {

/// Records the events of a stage.
struct EventRecorder {
  std::vector<std::string> warnings, notes, started;
  std::vector<StepDone> steps;

  /// Valid as long as the recorder lives.
  Listener AsListener() {
    return [this](const Event& event) {
      if (const auto* warning = std::get_if<Warning>(&event)) warnings.push_back(warning->text);
      if (const auto* note = std::get_if<Note>(&event)) notes.push_back(note->text);
      if (const auto* stage = std::get_if<StageStarted>(&event)) started.push_back(stage->stage);
      if (const auto* step = std::get_if<StepDone>(&event)) steps.push_back(*step);
    };
  }
};

}  // namespace oraclegs
