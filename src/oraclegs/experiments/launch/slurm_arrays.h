#pragma once
// How jobs that wait are put into arrays.

#include <cstddef>
#include <vector>

namespace oraclegs {

inline constexpr size_t kMaxSlurmArray =
    1000;  ///< tasks of an array: Slurm's own limit, unless the cluster's is another

struct SlurmArrays {
  std::vector<size_t> sizes = {};  ///< of the arrays, from the first job that waits on; the others wait for room
  size_t throttle = 0;             ///< tasks of each array that run at a time, 0 = as many as the cluster starts
};

/// `waiting` jobs, beside `running` ones that are submitted and have not ended. limit: those that may run at a time, 0
/// = any number. Slurm throttles within one array only, so what comes later waits for room.
SlurmArrays PlanSlurmArrays(size_t waiting, size_t running, size_t limit);

}  // namespace oraclegs
