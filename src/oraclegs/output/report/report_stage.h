#pragma once

#include "oraclegs/stages/stage.h"

namespace oraclegs {

/// Stage "report": what a run made, to look at: OUT/report/ (report/run_document.h), OUT/report.html, which holds all
/// of it in one file, and the video of an orbit. Where the web pages are not part of the program, report.html is left
/// out with a note.
StageWork ReportStage();

}  // namespace oraclegs
