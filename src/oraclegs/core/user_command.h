#pragma once
// A program of the user that reads a request folder and fills an answer folder: --generator, --masks.

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>

#include "oraclegs/core/progress.h"

namespace oraclegs {

/// Folders of one command.
struct CommandFolders {
  std::filesystem::path root;

  std::filesystem::path request() const { return root / "request"; }
  std::filesystem::path answer() const { return root / "answer"; }
  std::filesystem::path log() const { return root / "log.txt"; }
};

/// Empties the folder and makes answer/. Throws RunError.
void EmptyCommandFolders(const CommandFolders& folders);

/// The images that a command is to answer with.
struct AwaitedAnswers {
  std::string stage;              ///< that reports them, as StepDone
  std::string what;               ///< "generated views"
  size_t total = 0;               ///< images
  std::function<size_t()> count;  ///< images that are there
};

struct UserCommand {
  std::string option;  ///< for messages: "--generator"
  std::string text;    ///< for sh; {request} and {answer} are replaced by the two folders
  int timeout = 0;     ///< seconds, 0 = none
  CommandFolders folders;
};

/// Throws UsageError unless the text is UTF-8, as the settings of a run are.
void RequireUtf8Command(const std::string& option, const std::string& text);

/// The command with {request} and {answer} replaced by the folders, quoted for sh.
std::string FilledCommand(const std::string& command, const CommandFolders& folders);

/// Runs the command in this process's working directory, with the folders also in ORACLEGS_REQUEST and ORACLEGS_ANSWER
/// and its output in the log. Reports the number of answers at intervals, with the last line that was printed. Throws
/// RunError when the command fails or takes too long.
void RunUserCommand(const UserCommand& command, const AwaitedAnswers& awaited, const Listener& listener);

}  // namespace oraclegs
