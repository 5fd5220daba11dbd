#pragma once
// What each stage of a run took and gave, as a block of text.

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace oraclegs {

/// One line for each finished stage: its time, what it gave, and "unchanged" where its record is the one that stood
/// there `before` the run (an empty object when there was none, or when it was removed).
std::string StageTable(const nlohmann::json& before, const nlohmann::json& after);

}  // namespace oraclegs
