#pragma once
// --help: the commands, and the options of one.

#include <string>

#include "command_info.h"

namespace oraclegs {

/// `oraclegs --help`: the commands in groups, and where to start.
std::string OverviewText(const Catalog& commands);

/// The help of a command: its basic options (--help) or all that it shows (--help-all), in two columns, lines of at
/// most 100 characters. The short help is one list in the order in which a beginner needs them.
std::string HelpText(const CommandInfo& command, bool all);

/// `oraclegs help settings`: the settings of a command by group, as its long help has flags.
std::string SettingsText(const CommandInfo& command);

/// "oraclegs render [OPTIONS] input".
std::string UsageOf(const CommandInfo& command);

/// "-o, --out PATH", "--report, --no-report".
std::string NamesOf(const OptionInfo& option);

/// "Divide the photos' size by this [1 .. 64, default 1]".
std::string ExplanationOf(const OptionInfo& option);

}  // namespace oraclegs
