#pragma once
// What caching needs, once for all stages: key, skip, undo, run, time, record.

#include <string>
#include <vector>

#include "oraclegs/stages/stage.h"

namespace oraclegs {

/// SHA-256 of name, version, own options and inputs, and of the keys of the stages it needs; "" for a stage that the
/// run does not want.
std::string StageKey(Run* run, const std::vector<Stage>& stages, const std::string& name);

/// True when the stage was finished under its present key and its files are still there.
bool IsUpToDate(Run* run, const std::vector<Stage>& stages, const std::string& name);

/// Brings a stage up to date, after those it needs: its result is then held in run->results, its files and its record
/// are in the workspace. A stage that was finished under the same key is read back, or left alone where its result is
/// its files; every other one is forgotten, undone and run. Throws what stages throw; a stage that was stopped is not
/// believed to be finished.
void RunStage(Run* run, const std::vector<Stage>& stages, const std::string& name);

/// Brings this stage alone up to date, from the files of those it needs as they are, up to date or not.
void RunStageAlone(Run* run, const std::vector<Stage>& stages, const std::string& name);

}  // namespace oraclegs
