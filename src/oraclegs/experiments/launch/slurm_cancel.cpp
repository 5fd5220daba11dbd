#include "oraclegs/experiments/launch/slurm_cancel.h"

#include <algorithm>
#include <chrono>
#include <thread>
#include <vector>

#include "oraclegs/core/error.h"
#include "oraclegs/core/folder_lock.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/plural.h"
#include "oraclegs/experiments/launch/slurm_programs.h"
#include "oraclegs/experiments/launch/slurm_record.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

// Slurm kills tasks that do not end by themselves after KillWait, 30 s by default.
constexpr std::chrono::minutes kCancelPatience(3);
constexpr std::chrono::milliseconds kFirstPause(50), kLongestPause(2000);

bool MayRun(const SlurmRecord& record) {
  return std::any_of(record.submissions.begin(), record.submissions.end(), [](const auto& submission) {
    return std::any_of(submission.tasks.begin(), submission.tasks.end(), [](const auto& task) { return task.open; });
  });
}

/// True when the record has this array, or an array whose number it does not know.
bool MayHave(const SlurmRecord& record, const std::string& array) {
  return std::any_of(record.submissions.begin(), record.submissions.end(),
                     [&](const auto& submission) { return submission.array.empty() || submission.array == array; });
}

std::vector<SlurmTaskId> ActiveTasks(const SlurmRecord& record) {
  std::vector<SlurmTaskId> active;
  for (const auto& [task, found] : QueueOfSlurm(record.name, record.cluster)) {
    if (found.state == SlurmState::kActive && MayHave(record, task.array)) active.push_back(task);
  }
  return active;
}

void Pause(std::chrono::milliseconds time) {
  constexpr std::chrono::milliseconds kStep(50);
  for (auto left = time; left.count() > 0; left -= kStep) {
    ThrowIfInterrupted();
    std::this_thread::sleep_for(std::min(left, kStep));
  }
}

}  // namespace

void CancelOpenSlurmTasks(const fs::path& folder, const Listener& listener) {
  if (!HasSlurmRecord(folder)) return;
  const SlurmRecord record = ReadSlurmRecord(folder);
  if (!MayRun(record)) return;
  RequireSlurm();
  const FolderLock lock(folder, std::chrono::seconds(5));  // programs of a killed process may still be ending
  if (lock.state() == FolderLock::State::kHeldByAnother) {
    throw RunError("{}: {} follows these jobs; wait for it or end it", folder.string(), lock.holder());
  }
  std::vector<SlurmTaskId> active = ActiveTasks(record);
  if (active.empty()) return;
  CancelInSlurm(record.name, active, record.cluster);
  listener(Note{fmt::format("cancelled {} of an earlier start in Slurm", Counted(active.size(), "job"))});
  const auto until = Clock::now() + kCancelPatience;
  for (auto pause = kFirstPause; !active.empty(); pause = std::min(pause * 2, kLongestPause)) {
    if (Clock::now() > until) {
      throw RunError("{}: {} of array {} in Slurm were cancelled and do not end; wait for that, then run this again",
                     folder.string(), Counted(active.size(), "job"), active.front().array);
    }
    Pause(pause);
    active = ActiveTasks(record);
  }
}

}  // namespace oraclegs
