#pragma once
// Division of waiting jobs into arrays.

#include <cstddef>
#include <vector>

namespace oraclegs {

inline constexpr size_t kMaxSlurmArray = 1000;  ///< tasks of an array; Slurm's default limit

struct SlurmArrays {
  std::vector<size_t> sizes = {};  ///< tasks of each array, in the order of the waiting jobs; remaining jobs wait
  size_t throttle = 0;             ///< tasks of each array that run at a time; 0 = as many as the cluster starts
};

/// Plans arrays for `waiting` jobs while `running` jobs are submitted and have not ended. limit: jobs that may run at a
/// time, 0 = any number. Slurm throttles within one array only, so later jobs wait until there is room.
SlurmArrays PlanSlurmArrays(size_t waiting, size_t running, size_t limit);

}  // namespace oraclegs
