#include "oraclegs/experiments/launch/slurm_verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <csignal>

#include "oraclegs/core/process_group.h"
#include "oraclegs/core/subprocess.h"
#include "oraclegs/core/text.h"

namespace oraclegs {
namespace {

constexpr int kKilled = kKilledBySignal + SIGKILL, kToldToEnd = kKilledBySignal + SIGTERM;

/// State of a task. The queue is never behind; the accounts are written later and remember longer.
std::optional<SlurmState> StateOf(const SlurmEvidence& evidence) {
  if (evidence.queue) return evidence.queue->state;
  if (evidence.accounts) return evidence.accounts->state;
  return std::nullopt;
}

JobResult Failure(int exit_code, const std::filesystem::path& log) {
  JobResult result{.end = JobEnd::kFailed, .exit_code = exit_code, .why = {}};
  const std::string place = OneLine(log.string());
  if (exit_code == kKilled) {
    result.end = JobEnd::kOutOfMemory;
    result.why = "was killed by signal 9, as the kernel does where memory ends; ask for more with --slurm-memory";
  } else if (exit_code > kKilledBySignal) {
    result.why = fmt::format("was killed by signal {}; {} has its output", exit_code - kKilledBySignal, place);
  } else if (exit_code == kCannotStart) {
    result.why = fmt::format("the program was not found on the cluster's machine; {} has its output", place);
  } else {
    result.why = fmt::format("ended with exit code {}; {} has its output", exit_code, place);
  }
  return result;
}

/// Result of a task that has ended in this state.
JobResult ResultOf(SlurmState state, int exit_code, const std::filesystem::path& log) {
  switch (state) {
    case SlurmState::kOutOfMemory:
      return {.end = JobEnd::kOutOfMemory,
              .exit_code = exit_code,
              .why = "Slurm ended it for its memory; ask for more with --slurm-memory"};
    case SlurmState::kTimeLimit:
      return {.end = JobEnd::kOutOfTime,
              .exit_code = exit_code,
              .why = "Slurm ended it at its time limit; ask for more with --slurm-time"};
    case SlurmState::kPreempted:
      return {.end = JobEnd::kCancelled, .exit_code = exit_code, .why = "was preempted by another job"};
    case SlurmState::kNodeFailed:
      return {.end = JobEnd::kCancelled, .exit_code = exit_code, .why = "its machine failed"};
    case SlurmState::kCancelled:
      return {.end = JobEnd::kCancelled, .exit_code = exit_code, .why = "was cancelled"};
    case SlurmState::kCompleted:
      return {.exit_code = 0, .why = {}};
    case SlurmState::kFailed:
    case SlurmState::kActive:
      break;
  }
  return Failure(exit_code, log);
}

}  // namespace

bool HasEndedInSlurm(const SlurmEvidence& evidence) {
  return !evidence.queue || evidence.queue->state != SlurmState::kActive;
}

std::optional<JobResult> SlurmVerdict(const SlurmEvidence& evidence, const std::filesystem::path& log) {
  const std::optional<SlurmTaskEnd>& file = evidence.file;
  const bool done = file && file->exit_code == 0;  // its results are complete, whatever happened to the rest
  if (!HasEndedInSlurm(evidence) && (!done || evidence.looks < kSlurmFileLooks)) return std::nullopt;
  std::optional<SlurmState> state = StateOf(evidence);
  if (state == SlurmState::kActive) state.reset();  // the accounts are behind
  const bool script_speaks = !state || *state == SlurmState::kCompleted || *state == SlurmState::kFailed;
  if (!file && script_speaks && evidence.looks < kSlurmFileLooks) return std::nullopt;

  int exit_code = 1;
  if (evidence.accounts && evidence.accounts->exit_code) exit_code = *evidence.accounts->exit_code;
  if (file) exit_code = file->exit_code;
  JobResult result;
  if (done) {
    result.why = "";
  } else if (state) {
    result = ResultOf(*state, exit_code, log);
  } else if (file && !(file->asked_to_end && exit_code != 0)) {
    result = Failure(exit_code, log);
  } else {  // squeue has forgotten it, and there are no accounts
    result = {.end = JobEnd::kCancelled,
              .exit_code = file ? exit_code : kToldToEnd,
              .why = file ? "Slurm ended it" : "Slurm does not know it any more"};
  }
  if (evidence.accounts) {
    result.seconds = evidence.accounts->seconds;
    result.peak_bytes = evidence.accounts->peak_bytes;
  }
  if (file) {
    result.seconds = file->seconds;
    result.peak_bytes = std::max(result.peak_bytes, file->peak_bytes);
  }
  return result;
}

bool IsWorthAnotherTry(const JobResult& result) {
  if (result.end == JobEnd::kCancelled) return true;
  const int code = result.exit_code;  // 2 and 3: core/error.h; 126 and 127: the shell's
  return result.end == JobEnd::kFailed && code != 2 && code != 3 && code != 126 && code != 127;
}

}  // namespace oraclegs
