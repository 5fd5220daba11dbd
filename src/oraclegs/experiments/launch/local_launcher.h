#pragma once
// Launcher of jobs as child processes on this machine.

#include <string>
#include <string_view>
#include <vector>

#include "oraclegs/experiments/launch/launcher.h"

namespace oraclegs {

struct LocalWorkers {
  int count = 1;                       ///< jobs at once, at least 1
  std::vector<std::string> gpus = {};  ///< CUDA_VISIBLE_DEVICES of the workers, in turn; empty = unchanged
};

/// Runs jobs in process groups of their own, which end when this process does, however it ends. Peak memory is that of
/// the largest process of a job, and at least that of this process when the job began.
class LocalLauncher : public Launcher {
 public:
  explicit LocalLauncher(LocalWorkers workers) : workers_(std::move(workers)) {}

  void Run(const std::vector<Job>& jobs, const std::function<void(size_t job, const JobResult& result)>& ended,
           const Listener& listener) override;

 private:
  LocalWorkers workers_;
};

/// Classifies an exit code (process_group.h's convention). memory_was_short: the kernel has ended a process for its
/// memory meanwhile; last_line: last line of the job's output.
JobEnd EndOfChild(int exit_code, bool memory_was_short, std::string_view last_line);

}  // namespace oraclegs
