#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace oraclegs {

struct ProcessResult {
  int exit_code = 0;   ///< 127 when the program could not be started; 128 + n when killed by signal n
  std::string output;  ///< the last 64 KiB of stdout and stderr together
};

/// Runs argv[0] (found in PATH) without a shell, stdin closed, output appended to `log` when given, each line handed
/// to on_line. An interrupt (core/interrupt.h) ends the child and throws Interrupted.
ProcessResult RunProcess(const std::vector<std::string>& argv, const std::filesystem::path& log = {},
                         const std::function<void(const std::string& line)>& on_line = {});

/// Full path of a program in PATH, empty when there is none.
std::filesystem::path FindProgram(const std::string& name);

}  // namespace oraclegs
