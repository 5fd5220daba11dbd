#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "oraclegs/stages/stage.h"

namespace oraclegs {

/// Content of metrics.json, from the records of the finished stages and that of "evaluate" (docs/formats.md lists the
/// keys).
nlohmann::json MetricsToJson(const Run& run, const nlohmann::json& evaluate_record);

/// Reads a workspace's metrics.json. Throws InputError naming it.
nlohmann::json ReadMetrics(const std::filesystem::path& workspace);

/// Processor time of the process and of the programs it has waited for, all threads together, seconds.
double CpuSeconds();

}  // namespace oraclegs
