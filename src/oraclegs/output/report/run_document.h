#pragma once
// The run document: everything the report and the viewer show of a run, as JSON, with the files it names below
// OUT/report/ (docs/formats.md#report).

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "oraclegs/stages/evaluate_stage.h"
#include "oraclegs/stages/stage.h"

namespace oraclegs {

/// Writes OUT/report/run.json as training begins, in place of an older one: the training views and the proposals. A
/// file that cannot be written is a warning. ViewsOf(run) are in memory.
void WriteStartDocument(Run* run);

/// The document of a finished run, written to OUT/report/ with the files that it names; it is returned, too. `video`:
/// of an orbit, below OUT; empty = there is none. Throws InputError, RunError.
nlohmann::json WriteRunDocument(Run* run, const Model& model, const std::filesystem::path& video);

/// The command that makes the run again: the scene, and the options that are not the defaults, quoted for a shell.
std::string CommandOf(const Run& run);

}  // namespace oraclegs
