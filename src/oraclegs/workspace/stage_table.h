#pragma once
// Time and result of each stage of a run, as a block of text.

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace oraclegs {

/// One line for each finished stage: its time, its result, and "unchanged" where its record equals the one `before` the
/// run (an empty object when there was none, or when it was removed).
std::string StageTable(const nlohmann::json& before, const nlohmann::json& after);

}  // namespace oraclegs
