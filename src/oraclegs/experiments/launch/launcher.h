#pragma once
// Launchers of a suite's runs: each run is a child process, on this machine or on a cluster's.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "oraclegs/core/progress.h"

namespace oraclegs {

/// One run: a command that ends by itself and leaves its results in files.
struct Job {
  std::string name;                  ///< for messages, unique among the jobs
  std::vector<std::string> command;  ///< argv; no shell sees it
  std::filesystem::path log;         ///< its output is appended to this file
};

enum class JobEnd {
  kDone,         ///< exit code 0
  kFailed,       ///< another exit code, or the program could not be started
  kOutOfMemory,  ///< the kernel or the cluster ended it for its memory
  kOutOfTime,    ///< the cluster ended it at its time limit
  kCancelled,    ///< somebody ended it; it may be run again
};

struct JobResult {
  JobEnd end = JobEnd::kDone;
  int exit_code = 0;
  double seconds = 0;      ///< wall time
  int64_t peak_bytes = 0;  ///< resident; 0 = not known
  std::string why;         ///< one line for people; "" for kDone
};

class Launcher {
 public:
  virtual ~Launcher() = default;

  /// Runs all jobs, some at once, and calls `ended` from this thread as each ends, in any order. A job that fails is a
  /// result, not an exception. Throws Interrupted after ending the running jobs, RunError when nothing can be started
  /// at all (there is no such cluster), and the exceptions of `ended`.
  virtual void Run(const std::vector<Job>& jobs, const std::function<void(size_t job, const JobResult& result)>& ended,
                   const Listener& listener) = 0;
};

}  // namespace oraclegs
