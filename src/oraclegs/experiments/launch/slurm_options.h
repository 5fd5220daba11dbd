#pragma once
// Options of a cluster: the resources of a task, and arrays of tasks.

#include <cstddef>
#include <string>
#include <vector>

#include "oraclegs/core/options.h"

namespace oraclegs {

/// Resources that a task asks Slurm for. An empty text or 0 leaves the choice to the cluster.
struct SlurmOptions {
  std::string partition;
  std::string time;
  int cpus = 0;
  int gpus = 0;
  std::string memory;
  int max_running = 0;
  int retries = 2;
  double poll_seconds = 10;
  std::vector<std::string> arguments;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("slurm-partition", self.partition, "Of --launcher slurm: the partition; that of the cluster unless given");
    visit(
        "slurm-time", self.time,
        "Of --launcher slurm: the time limit of a job, as sbatch reads it (HOURS:MINUTES:SECONDS); a job that ends at "
        "it goes on when the same command is given again");
    visit("slurm-cpus", self.cpus, "Of --launcher slurm: processor cores of a job, 0 = as the cluster has it",
          Range{0, 4096});
    visit("slurm-gpus", self.gpus, "Of --launcher slurm: GPUs of a job, 0 = none is asked for", Range{0, 64});
    visit("slurm-memory", self.memory, "Of --launcher slurm: memory of a job, as sbatch reads it (32G)");
    visit("slurm-max-running", self.max_running,
          "Of --launcher slurm: jobs that run at a time, 0 = as many as the cluster starts", Range{0, 100000});
    visit(
        "slurm-retries", self.retries,
        "Of --launcher slurm: how often a job is submitted again that failed, was cancelled or preempted, or lost its "
        "machine",
        Range{0, 100});
    visit("slurm-poll", self.poll_seconds, "Of --launcher slurm: seconds between two looks at the queue",
          Range{0.01, 3600});
    visit("slurm-arguments", self.arguments,
          "Of --launcher slurm: more arguments of sbatch, in the form --slurm-arguments=--account=NAME");
  }
};

/// Arguments of sbatch for these options.
std::vector<std::string> SbatchArguments(const SlurmOptions& options);

inline constexpr size_t kMaxSlurmArray = 1000;  ///< tasks of an array; Slurm's default limit

/// Division of waiting jobs into arrays.
struct SlurmArrays {
  std::vector<size_t> sizes = {};  ///< tasks of each array, in the order of the waiting jobs; remaining jobs wait
  size_t throttle = 0;             ///< tasks of each array that run at a time; 0 = as many as the cluster starts
};

/// Plans arrays for `waiting` jobs while `running` jobs are submitted and have not ended. limit: jobs that may run at a
/// time, 0 = any number. Slurm throttles within one array only, so later jobs wait until there is room.
SlurmArrays PlanSlurmArrays(size_t waiting, size_t running, size_t limit);

}  // namespace oraclegs
