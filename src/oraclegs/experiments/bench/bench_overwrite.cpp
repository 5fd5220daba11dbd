#include "oraclegs/experiments/bench/bench_overwrite.h"

#include <chrono>
#include <filesystem>

#include "oraclegs/core/error.h"
#include "oraclegs/core/folder_lock.h"
#include "oraclegs/experiments/bench/run_record.h"
#include "oraclegs/experiments/launch/slurm_cancel.h"
#include "oraclegs/experiments/launch/slurm_record.h"
#include "oraclegs/workspace/saved_run.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

// Another machine of a cluster may release a lock a little after its task has ended.
constexpr std::chrono::seconds kWorkspacePatience{2};

void RequireIdle(const fs::path& workspace) {
  const FolderLock lock(workspace, kWorkspacePatience);
  if (lock.state() != FolderLock::State::kHeldByAnother) return;
  throw RunError("{}: another oraclegs still works there ({}); wait for it or end it, then run the same command again",
                 workspace.string(), lock.holder());
}

/// Removes a file or a whole folder, if it exists.
void Remove(const fs::path& path) {
  std::error_code error;
  fs::remove_all(path, error);
  if (!error) return;
  throw RunError("{}: cannot be removed: {}; remove it, then run the same command again", path.string(),
                 error.message());
}

}  // namespace

void RemoveRuns(const BenchRequest& request, const BenchPlan& plan, const Listener& listener) {
  const fs::path slurm = request.out / kSlurmFolder;
  CancelOpenSlurmTasks(slurm, listener);
  for (const BenchRun& run : plan.runs) RequireIdle(WorkspaceOf(request, run));
  if (HasSlurmRecord(slurm)) Remove(slurm);
  for (const BenchRun& run : plan.runs) {
    const fs::path workspace = WorkspaceOf(request, run);
    if (IsWorkspace(workspace)) Remove(workspace);
    Remove(RecordFile(workspace));
    Remove(LogFile(workspace));
  }
}

}  // namespace oraclegs
