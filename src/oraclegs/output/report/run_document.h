#pragma once
// Run document: everything that the report and the viewer show of a run, as JSON, with the files it names below
// OUT/report/ (docs/formats.md#report).

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "oraclegs/stages/evaluate_stage.h"
#include "oraclegs/stages/stage.h"

namespace oraclegs {

/// Writes OUT/report/run.json of a run that goes on (RunObserver::Show): some photos, once they are read, and the
/// training views with the proposals that there are, once poses are known and as training begins. That of a finished
/// run stays until training begins. Nothing with --no-report. A file that cannot be written is a warning.
void ShowDocument(Run* run, const std::string& stage);

/// Writes the document of a run that is finished, or was stopped and has a splat, with the files that it names, to
/// OUT/report/ and returns it. `video` is that of an orbit, below OUT; empty = none. Throws InputError, RunError.
nlohmann::json WriteRunDocument(Run* run, const Model& model, const std::filesystem::path& video);

/// Writes the document and, in a build with the web pages, report.html. Returns the names of both.
std::vector<std::string> WriteReport(Run* run, const Model& model, const std::filesystem::path& video);

/// Command that makes the run again: the scene, and the options that differ from the defaults, quoted for a shell.
std::string CommandOf(const Run& run);

/// Stage "report": OUT/report/ (WriteRunDocument) shows the results of a run, OUT/report.html holds all of it in
/// one file, and a video shows an orbit. In a build without the web pages report.html is left out with a note.
StageWork ReportStage();

}  // namespace oraclegs
