#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace oraclegs {

struct ProcessRequest {
  std::vector<std::string> argv;                                    ///< argv[0] is found in PATH; no shell sees it
  std::filesystem::path log = {};                                   ///< output is appended to it; empty: to none
  std::function<void(const std::string& line)> on_line = {};        ///< gets each line of output
  std::function<void()> while_running = {};                         ///< is called many times a second
  std::function<std::string()> next_input = {};                     ///< the next bytes of stdin; empty: the end of it
  std::vector<std::pair<std::string, std::string>> variables = {};  ///< environment variables beside this process's
  std::optional<std::chrono::duration<double>> time_limit = {};     ///< then the process and its children are ended
  /// Then a program that neither prints nor reads nor computes is ended.
  std::optional<std::chrono::duration<double>> stall_limit = {};
  bool errors_apart = false;  ///< stderr has a pipe of its own: last_error is known, the order of the two is not
};

struct ProcessResult {
  int exit_code = 0;       ///< 127 when the program could not be started; 128 + n when killed by signal n
  std::string output;      ///< the last 64 KiB of stdout and stderr together
  std::string last_error;  ///< with errors_apart, the last line of stderr that is not blank
  bool timed_out = false;  ///< the time limit was reached
  bool stalled = false;    ///< the stall limit was reached
};

/// Runs a program and waits for it; its stdin is closed unless it is fed by next_input, whose bytes are dropped once
/// the program reads no more. An interrupt (core/interrupt.h), an exception of a callback or the end of the time limit
/// ends it; an interrupt throws Interrupted. Children that it leaves in its process group end with it, and all end when
/// this process dies (core/process_group.h).
ProcessResult RunProcess(const ProcessRequest& request);

/// Runs `argv` as the other does, with the settings that most callers need.
ProcessResult RunProcess(const std::vector<std::string>& argv, const std::filesystem::path& log = {},
                         const std::function<void(const std::string& line)>& on_line = {});

/// ProcessResult::exit_code of a program that could not be started, also by the shell or the loader.
inline constexpr int kCannotStart = 127;

/// Whether a program with this ProcessResult::exit_code was ended by a signal that does not come from a fault of its
/// own.
bool WasKilled(int exit_code);

/// How long a program that we run may do nothing: ORACLEGS_STALL_LIMIT (seconds, above 0), else two minutes.
std::chrono::duration<double> StallLimit();

}  // namespace oraclegs
