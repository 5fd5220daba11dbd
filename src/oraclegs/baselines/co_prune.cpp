#include "oraclegs/baselines/co_prune.h"

#include "oraclegs/core/parallel.h"
#include "oraclegs/gaussians/neighbors.h"

namespace oraclegs {

std::vector<uint8_t> CoPruneKeep(const Gaussians& model, const Gaussians& other, double max_distance) {
  model.Check("CoPruneKeep");
  other.Check("CoPruneKeep");
  constexpr int64_t kGrain = 1024;  // Gaussians a task
  const auto center = [](const Gaussians& g, int64_t i) -> Eigen::Vector3f {
    return Eigen::Vector3f::Map(g.means.data() + 3 * i);
  };
  std::vector<Eigen::Vector3f> others(static_cast<size_t>(other.size()));
  for (int64_t i = 0; i < other.size(); ++i) others[i] = center(other, i);
  const KdTree tree(others);
  std::vector<uint8_t> keep(static_cast<size_t>(model.size()));
  ParallelBlocks(model.size(), kGrain, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) keep[i] = tree.HasWithin(center(model, i), max_distance);
  });
  return keep;
}

}  // namespace oraclegs
