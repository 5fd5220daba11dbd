#pragma once

#include "oraclegs/stages/stage.h"

namespace oraclegs {

/// Text block with one line for each finished stage: its time, what it gave, and "unchanged" where its record is the
/// one that stood there `before` the run (an empty object when there was none, or when it was removed).
std::string StageTable(const std::vector<Stage>& stages, const nlohmann::json& before, const nlohmann::json& after);

}  // namespace oraclegs
