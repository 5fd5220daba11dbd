#pragma once
// The program's log: lines on stderr, so that stdout stays free for results. The library reports through
// core/progress.h; only front ends write here.

#include <spdlog/logger.h>

namespace oraclegs {

enum class Verbosity {
  kQuiet,    ///< warnings and errors
  kNormal,   ///< also what a user wants to know of a run that goes well
  kVerbose,  ///< also what helps to find a fault
};

/// The one logger, at kNormal until SetVerbosity is called. A line reads "info: text"; colored on a terminal.
/// Characters that steer a terminal, or end the line, become '?'.
spdlog::logger& Log();

void SetVerbosity(Verbosity verbosity);

}  // namespace oraclegs
