#pragma once
// Where the runs of a suite happen: each is a child process, on this machine or on a cluster's.

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
  std::filesystem::path log;         ///< its output is appended to it
};

enum class JobEnd {
  kDone,         ///< exit code 0
  kFailed,       ///< another one, or the program could not be started
  kOutOfMemory,  ///< the kernel or the cluster ended it for its memory
  kOutOfTime,    ///< the cluster ended it at its time limit
  kCancelled,    ///< somebody ended it; it may be run again
};

struct JobResult {
  JobEnd end = JobEnd::kDone;
  int exit_code = 0;
  double seconds = 0;      ///< of wall time
  int64_t peak_bytes = 0;  ///< resident; 0 = not known
  std::string why;         ///< one line for people; "" where it is done
};

class Launcher {
 public:
  virtual ~Launcher() = default;

  /// Runs all jobs, some at once, and calls `ended` from this thread as each ends, in any order. A job that fails is
  /// a result, not an exception. Throws Interrupted after ending what runs, RunError where nothing can be started at
  /// all (there is no such cluster), and what `ended` throws.
  virtual void Run(const std::vector<Job>& jobs, const std::function<void(size_t job, const JobResult& result)>& ended,
                   const Listener& listener) = 0;
};

}  // namespace oraclegs
