#pragma once
// sbatch, squeue, sacct and scancel, and parsers of their output.

#include <compare>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace oraclegs {

/// One task of an array.
struct SlurmTaskId {
  std::string array;  ///< number of the array
  int index = 0;
  auto operator<=>(const SlurmTaskId&) const = default;
};

enum class SlurmState {
  kActive,  ///< waits, runs, or is being cleaned up
  kCompleted,
  kFailed,
  kOutOfMemory,
  kTimeLimit,
  kCancelled,  ///< also revoked
  kPreempted,
  kNodeFailed,
};

struct SlurmTaskState {
  SlurmState state = SlurmState::kActive;
  std::string reason;            ///< why it waits, in Slurm's word; "" = not said
  std::optional<int> exit_code;  ///< 128 + n when signal n ended it; from sacct only
  double seconds = 0;            ///< wall time, from sacct only; 0 = not known
  int64_t peak_bytes = 0;        ///< from sacct only; 0 = not known
};

using SlurmTaskStates = std::map<SlurmTaskId, SlurmTaskState>;

/// Identity of a submitted array.
struct SlurmArray {
  std::string id;
  std::string cluster;  ///< "" = the default cluster of all programs
};

/// True for digits only, as in the numbers of arrays. Numbers read from files may be any text.
bool IsSlurmNumber(std::string_view text);

/// State of "COMPLETED", "CANCELLED by 1000", "NODE_FAIL+". An unknown word is kActive, since all ends are known.
SlurmState SlurmStateOf(const std::string& word);

/// Parses squeue with the format "%F|%K|%T|%r"; lines that are no task of an array are left out.
SlurmTaskStates ParseSqueue(const std::string& output);

/// Parses sacct --parsable2 with JobID,State,ExitCode,MaxRSS,ElapsedRaw; the peak is that of the largest step.
SlurmTaskStates ParseSacct(const std::string& output);

/// Parses sbatch --parsable; a site may print more lines. nullopt without a number.
std::optional<SlurmArray> ParseSbatch(const std::string& output);

/// Throws RunError that says what to do when Slurm is not installed here.
void RequireSlurm();

/// `arguments` follow "sbatch --parsable". Throws RunError with the line that sbatch prints.
SlurmArray SubmitToSlurm(const std::vector<std::string>& arguments);

/// All tasks of the user's jobs called `name` that Slurm still remembers. Throws RunError when squeue does not answer.
SlurmTaskStates QueueOfSlurm(const std::string& name, const std::string& cluster);

/// Tasks of these arrays in the cluster's accounts; nullopt when it keeps none or they do not answer.
std::optional<SlurmTaskStates> AccountsOfSlurm(const std::vector<std::string>& arrays, const std::string& cluster);

/// Cancels those of `tasks` that the queue has under `name`; their numbers may come from other people's files. Throws
/// RunError when squeue or scancel cannot reach the cluster. Tasks that have ended are no error.
void CancelInSlurm(const std::string& name, std::vector<SlurmTaskId> tasks, const std::string& cluster);

}  // namespace oraclegs
