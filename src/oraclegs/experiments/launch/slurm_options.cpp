#include "oraclegs/experiments/launch/slurm_options.h"

#include <fmt/format.h>

#include <algorithm>

namespace oraclegs {

std::vector<std::string> SbatchArguments(const SlurmOptions& options) {
  std::vector<std::string> arguments;
  if (!options.partition.empty()) arguments.push_back("--partition=" + options.partition);
  if (!options.time.empty()) arguments.push_back("--time=" + options.time);
  if (options.cpus > 0) arguments.push_back(fmt::format("--cpus-per-task={}", options.cpus));
  if (options.gpus > 0) arguments.push_back(fmt::format("--gres=gpu:{}", options.gpus));
  if (!options.memory.empty()) arguments.push_back("--mem=" + options.memory);
  arguments.insert(arguments.end(), options.arguments.begin(), options.arguments.end());
  return arguments;
}

SlurmArrays PlanSlurmArrays(size_t waiting, size_t running, size_t limit) {
  if (limit > 0) {
    // Each array runs at least one task.
    const size_t room = running > 0 ? limit - std::min(limit, running) : limit * kMaxSlurmArray;
    waiting = std::min(waiting, room);
  }
  SlurmArrays arrays;
  for (size_t first = 0; first < waiting; first += kMaxSlurmArray) {
    arrays.sizes.push_back(std::min(kMaxSlurmArray, waiting - first));
  }
  if (limit > 0 && !arrays.sizes.empty()) arrays.throttle = std::max<size_t>(1, limit / arrays.sizes.size());
  return arrays;
}

}  // namespace oraclegs
