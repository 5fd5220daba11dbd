#pragma once

#include <nlohmann/json_fwd.hpp>

#include "oraclegs/stages/stage.h"

namespace oraclegs {

/// Is the oracle right? Compares the validated proposals of a run with the images that were taken from the same
/// poses but neither trained on nor tested (--trajectory dataset), which nothing else reads. Writes oracle.json:
/// {"views": n, "psnr": of the proposals, "oracle": quality, "uniform": quality} (evaluate/oracle_quality.h, and in it
/// "blocks": evaluate/block_quality.h). Throws
/// InputError when the run has no proposal at such a pose.
nlohmann::json ReportOracle(const Run& run);

}  // namespace oraclegs
