#include "oraclegs/experiments/launch/slurm_options.h"

#include <fmt/format.h>

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

}  // namespace oraclegs
