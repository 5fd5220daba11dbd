#pragma once
// Results of a run in numbers: its scores, its stages, and how right its oracle is.

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

/// Text block with one line for each finished stage: its time, what it gave, and "unchanged" where its record is the
/// one that stood there `before` the run (an empty object when there was none, or when it was removed).
std::string StageTable(const std::vector<Stage>& stages, const nlohmann::json& before, const nlohmann::json& after);

/// Is the oracle right? Compares the validated proposals of a run with the images that were taken from the same
/// poses but neither trained on nor tested (--trajectory dataset), which nothing else reads. Writes oracle.json:
/// {"views": n, "psnr": of the proposals, "oracle": quality, "uniform": quality} (evaluate/oracle_quality.h, and in it
/// "blocks": evaluate/block_quality.h). Throws InputError when the run has no proposal at such a pose.
nlohmann::json ReportOracle(const Run& run);

}  // namespace oraclegs
