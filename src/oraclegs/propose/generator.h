#pragma once
// --generator: a user's program that generates the views of all targets.

#include <filesystem>
#include <string>
#include <vector>

#include "oraclegs/core/progress.h"
#include "oraclegs/propose/generator_files.h"

namespace oraclegs {

/// Source of its proposals, and name of their folder.
inline constexpr const char* kGeneratorSource = "command";

struct GeneratorRun {
  std::string command;              ///< for sh; {request} and {answer} are replaced by the two folders
  int timeout = 0;                  ///< seconds, 0 = none
  std::filesystem::path proposals;  ///< proposals folder of the workspace
};

/// Runs the command (RunUserCommand) on the request in proposals/generator, and stores its answers as
/// proposals/command/NAME.png. Reports them as StepDone{"propose"}. Throws as RunUserCommand and ReadAnswers.
void RunGenerator(const GeneratorRun& run, const std::vector<Target>& targets, const Listener& listener);

/// Removes request, answers and stored images.
void RemoveGeneratorFiles(const std::filesystem::path& proposals);

}  // namespace oraclegs
