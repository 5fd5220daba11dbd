#include "oraclegs/experiments/launch/slurm_programs.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <chrono>
#include <sstream>
#include <utility>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/subprocess.h"
#include "oraclegs/core/text.h"

namespace oraclegs {
namespace {

/// Limit for one call. The programs have limits of their own, some of minutes; a cluster under load is slow, not gone.
constexpr std::chrono::duration<double> kProgramLimit(300);

std::vector<std::string> LinesOf(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::vector<std::string> FieldsOf(const std::string& line) {
  std::vector<std::string> fields(1);
  for (const char c : line) {
    if (c == '|') {
      fields.emplace_back();
    } else {
      fields.back() += c;
    }
  }
  return fields;
}

template <class Number>
std::optional<Number> NumberOf(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

/// Task of "123_4" or "123_4.batch"; nullopt for tasks that wait together ("123_[5-9]") and for jobs without an array.
std::optional<SlurmTaskId> TaskOf(const std::string& job) {
  const size_t line = job.find('_');
  if (line == std::string::npos || !IsSlurmNumber(job.substr(0, line))) return std::nullopt;
  const auto index = NumberOf<int>(std::string_view(job).substr(line + 1, job.find('.') - line - 1));
  if (!index) return std::nullopt;
  return SlurmTaskId{job.substr(0, line), *index};
}

/// Bytes of "123456K" or "1.5G"; 0 for other text.
int64_t BytesOf(const std::string& text) {
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || number < 0) return 0;
  const size_t power = end == text.data() + text.size() ? 0 : std::string_view("BKMGT").find(*end);
  if (power == std::string_view::npos) return 0;
  return static_cast<int64_t>(number * static_cast<double>(int64_t{1} << (10 * power)));
}

/// Exit code of "1:0", 128 + signal of "0:9".
std::optional<int> ExitCodeOf(const std::string& text) {
  const size_t colon = text.find(':');
  if (colon == std::string::npos) return std::nullopt;
  const auto code = NumberOf<int>(std::string_view(text).substr(0, colon));
  const auto signal = NumberOf<int>(std::string_view(text).substr(colon + 1));
  if (!code || !signal) return std::nullopt;
  return *signal > 0 ? 128 + *signal : *code;
}

/// Runs a Slurm program. `all` receives the whole output; the tail in ProcessResult is too short for a thousand tasks.
ProcessResult RunSlurm(std::vector<std::string> argv, const std::string& cluster, std::string* all = nullptr) {
  if (!cluster.empty()) argv.insert(argv.begin() + 1, "--clusters=" + cluster);
  ProcessRequest request{.argv = std::move(argv), .time_limit = kProgramLimit, .errors_apart = true};
  if (all) request.on_line = [all](const std::string& line) { *all += line + "\n"; };
  return RunProcess(request);
}

/// Error text of a failed Slurm program, without its name and log level.
std::string ReasonOf(const ProcessResult& result) {
  if (result.timed_out) return fmt::format("no answer in {:.0f} s", kProgramLimit.count());
  if (result.last_error.empty()) return fmt::format("exit code {}", result.exit_code);
  for (const std::string mark : {"error: ", "fatal: "}) {
    const size_t at = result.last_error.find(mark);
    if (at != std::string::npos) return OneLine(result.last_error.substr(at + mark.size()));
  }
  return OneLine(result.last_error);
}

}  // namespace

bool IsSlurmNumber(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
}

SlurmState SlurmStateOf(const std::string& word) {
  static constexpr std::pair<std::string_view, SlurmState> kStates[] = {
      {"COMPLETED", SlurmState::kCompleted},       {"FAILED", SlurmState::kFailed},
      {"OUT_OF_MEMORY", SlurmState::kOutOfMemory}, {"TIMEOUT", SlurmState::kTimeLimit},
      {"DEADLINE", SlurmState::kTimeLimit},        {"CANCELLED", SlurmState::kCancelled},
      {"REVOKED", SlurmState::kCancelled},         {"PREEMPTED", SlurmState::kPreempted},
      {"NODE_FAIL", SlurmState::kNodeFailed},      {"BOOT_FAIL", SlurmState::kNodeFailed},
      {"LAUNCH_FAILED", SlurmState::kNodeFailed}};
  const std::string first = word.substr(0, word.find_first_of(" +"));
  const auto* found =
      std::find_if(std::begin(kStates), std::end(kStates), [&](const auto& s) { return s.first == first; });
  return found == std::end(kStates) ? SlurmState::kActive : found->second;
}

SlurmTaskStates ParseSqueue(const std::string& output) {
  SlurmTaskStates states;
  for (const std::string& line : LinesOf(output)) {
    const std::vector<std::string> fields = FieldsOf(line);
    if (fields.size() < 4 || !IsSlurmNumber(fields[0])) continue;
    const auto index = NumberOf<int>(fields[1]);
    if (!index) continue;
    SlurmTaskState state{.state = SlurmStateOf(fields[2]), .reason = {}, .exit_code = {}};
    if (fields[2] == "PENDING" && fields[3] != "None") state.reason = fields[3];
    states[{fields[0], *index}] = state;
  }
  return states;
}

SlurmTaskStates ParseSacct(const std::string& output) {
  SlurmTaskStates states;
  for (const std::string& line : LinesOf(output)) {
    const std::vector<std::string> fields = FieldsOf(line);
    if (fields.size() < 5) continue;
    const std::optional<SlurmTaskId> task = TaskOf(fields[0]);
    if (!task) continue;
    SlurmTaskState& state = states[*task];
    state.peak_bytes = std::max(state.peak_bytes, BytesOf(fields[3]));
    if (fields[0].find('.') != std::string::npos) continue;  // a step
    state.state = SlurmStateOf(fields[1]);
    state.exit_code = ExitCodeOf(fields[2]);
    state.seconds = NumberOf<double>(fields[4]).value_or(0);
  }
  return states;
}

std::optional<SlurmArray> ParseSbatch(const std::string& output) {
  std::optional<SlurmArray> array;
  for (const std::string& line : LinesOf(output)) {
    const size_t end = line.find(';');
    if (!IsSlurmNumber(std::string_view(line).substr(0, end))) continue;
    array = SlurmArray{line.substr(0, end), end == std::string::npos ? "" : line.substr(end + 1)};
  }
  return array;
}

void RequireSlurm() {
  for (const char* program : {"sbatch", "squeue", "scancel"}) {
    if (!FindProgram(program).empty()) continue;
    throw RunError(
        "{} is not in PATH: install Slurm's programs here (Debian: slurm-client) and start this on a machine of the "
        "cluster, or run the jobs on this machine with --launcher local",
        program);
  }
}

SlurmArray SubmitToSlurm(const std::vector<std::string>& arguments) {
  std::vector<std::string> argv = {"sbatch", "--parsable"};
  argv.insert(argv.end(), arguments.begin(), arguments.end());
  const ProcessResult result = RunSlurm(std::move(argv), "");
  if (result.exit_code != 0) throw RunError("sbatch does not take the jobs: {}", ReasonOf(result));
  const std::optional<SlurmArray> array = ParseSbatch(result.output);
  if (!array) throw RunError("sbatch said no number of a job: '{}'", Printable(result.output));
  return *array;
}

SlurmTaskStates QueueOfSlurm(const std::string& name, const std::string& cluster) {
  std::string all;
  std::vector<std::string> argv = {"squeue",       "--noheader",     "--array",
                                   "--states=all", "--name=" + name, "--format=%F|%K|%T|%r"};
  const ProcessResult result = RunSlurm(std::move(argv), cluster, &all);
  if (result.exit_code != 0) throw RunError("squeue does not answer: {}", ReasonOf(result));
  return ParseSqueue(all);
}

std::optional<SlurmTaskStates> AccountsOfSlurm(const std::vector<std::string>& arrays, const std::string& cluster) {
  if (arrays.empty() || FindProgram("sacct").empty()) return std::nullopt;
  std::string all;
  std::vector<std::string> argv = {"sacct", "--noheader", "--parsable2",
                                   fmt::format("--jobs={}", fmt::join(arrays, ",")),
                                   "--format=JobID,State,ExitCode,MaxRSS,ElapsedRaw"};
  const ProcessResult result = RunSlurm(std::move(argv), cluster, &all);
  if (result.exit_code != 0) return std::nullopt;
  return ParseSacct(all);
}

void CancelInSlurm(const std::string& name, std::vector<SlurmTaskId> tasks, const std::string& cluster) {
  if (tasks.empty()) return;
  const SlurmTaskStates named = QueueOfSlurm(name, cluster);
  std::erase_if(tasks, [&](const SlurmTaskId& task) { return !named.contains(task); });
  constexpr size_t kAtOnce = 500;  // far from the longest command line
  for (size_t first = 0; first < tasks.size(); first += kAtOnce) {
    std::vector<std::string> argv = {"scancel"};
    for (size_t t = first; t < std::min(tasks.size(), first + kAtOnce); ++t) {
      argv.push_back(fmt::format("{}_{}", tasks[t].array, tasks[t].index));
    }
    const ProcessResult result = RunSlurm(std::move(argv), cluster);
    // scancel also fails when a task has ended meanwhile; the caller sees that in the queue.
    const bool ended = result.output.find("Invalid job id") != std::string::npos ||
                       result.output.find("already completing or completed") != std::string::npos;
    if (result.exit_code != 0 && !ended) throw RunError("scancel does not work: {}", ReasonOf(result));
  }
}

}  // namespace oraclegs
