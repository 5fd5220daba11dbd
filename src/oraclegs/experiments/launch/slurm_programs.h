#pragma once
// sbatch, squeue, sacct and scancel, and what they print.

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
  std::string array;  ///< the number of the array
  int index = 0;
  auto operator<=>(const SlurmTaskId&) const = default;
};

enum class SlurmState {
  kActive,  ///< waits, runs, or is being cleaned up after
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
  std::string reason;            ///< why it waits, in Slurm's word; "" where it does not say
  std::optional<int> exit_code;  ///< 128 + n when signal n ended it; of sacct alone
  double seconds = 0;            ///< of wall time; of sacct alone, 0 = not known
  int64_t peak_bytes = 0;        ///< of sacct alone, 0 = not known
};

using SlurmTaskStates = std::map<SlurmTaskId, SlurmTaskState>;

/// What an array that was submitted is called.
struct SlurmArray {
  std::string id;
  std::string cluster;  ///< "" = the one that all programs mean
};

/// True for digits alone, as the numbers of arrays are. Those of files may be anything.
bool IsSlurmNumber(std::string_view text);

/// "COMPLETED", "CANCELLED by 1000", "NODE_FAIL+": a word that is not known is active, since tasks end with the others.
SlurmState SlurmStateOf(const std::string& word);

/// Of squeue with the format "%F|%K|%T|%r"; lines that are no task of an array are left out.
SlurmTaskStates ParseSqueue(const std::string& output);

/// Of sacct --parsable2 with JobID,State,ExitCode,MaxRSS,ElapsedRaw; the peak is that of the largest step.
SlurmTaskStates ParseSacct(const std::string& output);

/// Of sbatch --parsable, whose site may print more. Nothing where there is no number.
std::optional<SlurmArray> ParseSbatch(const std::string& output);

/// Throws RunError that says what to do, when Slurm is not installed here.
void RequireSlurm();

/// `arguments` follow "sbatch --parsable". Throws RunError with the line that sbatch says.
SlurmArray SubmitToSlurm(const std::vector<std::string>& arguments);

/// All tasks of the user's jobs called `name` that Slurm still remembers. Throws RunError when squeue does not answer.
SlurmTaskStates QueueOfSlurm(const std::string& name, const std::string& cluster);

/// The same of arrays from the cluster's accounts; nothing where it keeps none, or they do not answer.
std::optional<SlurmTaskStates> AccountsOfSlurm(const std::vector<std::string>& arrays, const std::string& cluster);

/// Cancels those of `tasks`, whose numbers may be from files of others, that the queue has under `name`. Throws
/// RunError when squeue or scancel cannot reach the cluster. Tasks that have ended are no error.
void CancelInSlurm(const std::string& name, std::vector<SlurmTaskId> tasks, const std::string& cluster);

}  // namespace oraclegs
