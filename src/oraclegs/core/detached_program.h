#pragma once
// A program that goes on when this one ends, and is found again by a later one.

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace oraclegs {

/// A process of this machine. Numbers are given anew, so that its start belongs to it.
struct ProcessMark {
  int64_t number = 0;   ///< 0 = none
  int64_t started = 0;  ///< clock ticks after the machine's start
};

nlohmann::json ProcessMarkToJson(const ProcessMark& mark);
/// No mark for anything that ProcessMarkToJson does not write.
ProcessMark ProcessMarkFromJson(const nlohmann::json& json);

/// Starts a program in a session of its own, which reads nothing and appends what it prints to `log`. argv[0] is a path
/// or found in PATH. Throws RunError naming the program or the log.
ProcessMark StartDetached(const std::vector<std::string>& argv, const std::filesystem::path& log);

enum class ProgramState { kGone, kRuns, kPaused };

/// State of a process: gone once it ended, or when the number belongs to another one.
ProgramState StateOf(const ProcessMark& mark);

/// Sends a signal to a program started by StartDetached and to all that it started. False when it is gone or belongs to
/// another user.
bool SignalSession(const ProcessMark& mark, int signal);
/// Sends a signal to the program alone.
bool SignalProgram(const ProcessMark& mark, int signal);

}  // namespace oraclegs
