#pragma once
// Descriptions of the commands, from which --help, the man page and the shell completion are made.

#include <string>
#include <vector>

namespace oraclegs {

struct OptionInfo {
  std::string name;                     ///< without the dashes
  char letter = 0;                      ///< one-letter name, as in -o; 0 = none
  std::string value = {};               ///< "PATH": what stands for the value; empty for a flag
  std::string help = {};                ///< one or more sentences, without a full stop
  std::string values = {};              ///< "1 .. 64, default 1": range, words and default; may be empty
  std::string usual = {};               ///< "default 1"; empty when nothing, or a flag's off, is the default
  std::vector<std::string> words = {};  ///< all that it may be set to, when these are words
  std::string group = {};
  bool negatable = false;   ///< --no-NAME is there, too
  bool default_on = false;  ///< for flags
  bool basic = true;        ///< shown by --help; others by --help-all alone
  bool hidden = false;      ///< accepted, but of no use to this command: shown nowhere
};

struct ArgumentInfo {
  std::string name, value, help;
  bool required = true, many = false;
};

struct CommandInfo {
  std::string name, help, group;
  std::string example = {};  ///< one or more lines
  std::vector<ArgumentInfo> arguments = {};
  std::vector<OptionInfo> options = {};   ///< in the order of --help-all, also hidden ones
  std::vector<OptionInfo> settings = {};  ///< those of --set alone, by group
};

/// All commands in the order of the overview.
using Catalog = std::vector<CommandInfo>;

}  // namespace oraclegs
