#pragma once

#include "oraclegs/stages/stage.h"

namespace oraclegs {

/// Stage "report": OUT/report/ (report/run_document.h) shows the results of a run, OUT/report.html holds all of it in
/// one file, and a video shows an orbit. In a build without the web pages report.html is left out with a note.
StageWork ReportStage();

}  // namespace oraclegs
