#pragma once
// --generator: a program of the user's that generates the views of all targets.

#include <filesystem>
#include <string>
#include <vector>

#include "oraclegs/core/progress.h"
#include "oraclegs/propose/generator_files.h"

namespace oraclegs {

/// The source of its proposals, and their folder.
inline constexpr const char* kGeneratorSource = "command";

struct GeneratorRun {
  std::string command;              ///< for sh; {request} and {answer} stand for the two folders
  int timeout = 0;                  ///< seconds, 0 = none
  std::filesystem::path proposals;  ///< folder of the workspace
};

/// The command with the folders' names in place of {request} and {answer}, quoted for sh.
std::string FilledCommand(const std::string& command, const GeneratorPaths& paths);

/// Runs the command, in this process's working directory and with the folders also in ORACLEGS_REQUEST and
/// ORACLEGS_ANSWER, on the request that lies in proposals/generator, and stores what it answers as
/// proposals/command/NAME.png. Reports the images that are there as StepDone{"propose"}, with the last line that was
/// printed. Throws RunError when the command fails or takes too long, and as ReadAnswers.
void RunGenerator(const GeneratorRun& run, const std::vector<Target>& targets, const Listener& listener);

/// Removes request, answers and stored images.
void RemoveGeneratorFiles(const std::filesystem::path& proposals);

}  // namespace oraclegs
