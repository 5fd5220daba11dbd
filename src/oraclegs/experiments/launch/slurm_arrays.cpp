#include "oraclegs/experiments/launch/slurm_arrays.h"

#include <algorithm>

namespace oraclegs {

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
