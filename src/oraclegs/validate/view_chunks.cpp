#include "oraclegs/validate/view_chunks.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <tuple>

#include "oraclegs/core/error.h"
#include "oraclegs/core/rng.h"
#include "oraclegs/propose/nearest_order.h"

namespace oraclegs {
namespace {

/// Mean distance of the views' cameras from their center.
double SpreadOf(const std::vector<LoadedView>& views) {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (const LoadedView& view : views) center += view.camera.Center() / static_cast<double>(views.size());
  double spread = 0;
  for (const LoadedView& view : views) {
    spread += (view.camera.Center() - center).norm() / static_cast<double>(views.size());
  }
  return std::max(spread, 1e-9);
}

class Planner {
 public:
  Planner(const std::vector<Query>& queries, const std::vector<LoadedView>& views)
      : queries_(queries), views_(views), spread_(views.empty() ? 1 : SpreadOf(views)) {}

  void Add(std::vector<size_t> members) {
    if (const auto reference = Nearest(members)) {
      chunks_.push_back({std::move(members), *reference});
      return;
    }
    if (members.size() == 1) {
      throw InputError(
          "{}: VGGT has no view to compare it with, the only one is held out; give more training views, or use "
          "--oracle "
          "consistency",
          queries_[members[0]].proposal.name);
    }
    const auto half = members.begin() + static_cast<int64_t>(members.size() / 2);
    Add({members.begin(), half});
    Add({half, members.end()});
  }

  std::vector<ViewChunk> Take() { return std::move(chunks_); }

 private:
  std::optional<size_t> Nearest(const std::vector<size_t>& members) const {
    std::set<size_t> taken;
    for (const size_t m : members) {
      if (const auto held_out = queries_[m].held_out) taken.insert(static_cast<size_t>(*held_out));
    }
    const Camera& size = queries_[members[0]].proposal.camera;
    std::optional<size_t> best;
    std::pair<bool, double> lowest;
    for (size_t p = 0; p < views_.size(); ++p) {
      if (taken.count(p) > 0) continue;
      const Camera& camera = views_[p].camera;
      std::pair<bool, double> cost = {camera.width != size.width || camera.height != size.height, 0};
      for (const size_t m : members) {
        const Camera& other = queries_[m].proposal.camera;
        cost.second += (camera.Center() - other.Center()).norm() / spread_ + TurnBetween(camera, other);
      }
      if (best && !(cost < lowest)) continue;
      best = p, lowest = cost;
    }
    return best;
  }

  const std::vector<Query>& queries_;
  const std::vector<LoadedView>& views_;
  double spread_;
  std::vector<ViewChunk> chunks_;
};

}  // namespace

std::vector<std::pair<size_t, size_t>> EvenRuns(size_t count, size_t limit) {
  std::vector<std::pair<size_t, size_t>> runs;
  const size_t number = (count + std::max<size_t>(limit, 1) - 1) / std::max<size_t>(limit, 1);
  for (size_t r = 0; r < number; ++r) runs.emplace_back(r * count / number, (r + 1) * count / number);
  return runs;
}

std::vector<std::vector<size_t>> ShuffledRuns(size_t count, size_t limit, uint64_t seed) {
  std::vector<size_t> order(count);
  std::iota(order.begin(), order.end(), size_t{0});
  Rng rng(seed, RandomStream::kOraclePass);
  for (size_t left = count; left > 1; --left) {
    std::swap(order[left - 1], order[static_cast<size_t>(rng.Index(static_cast<int64_t>(left)))]);
  }
  std::vector<std::vector<size_t>> runs;
  for (const auto& [begin, end] : EvenRuns(count, limit)) {
    runs.emplace_back(order.begin() + static_cast<int64_t>(begin), order.begin() + static_cast<int64_t>(end));
  }
  return runs;
}

std::vector<ViewChunk> PlanChunks(const std::vector<Query>& queries, const std::vector<LoadedView>& views,
                                  size_t limit) {
  std::map<std::tuple<std::string, int, int>, std::vector<size_t>> groups;
  for (size_t q = 0; q < queries.size(); ++q) {
    const Proposal& p = queries[q].proposal;
    groups[{p.source, p.camera.width, p.camera.height}].push_back(q);
  }
  Planner planner(queries, views);
  for (const auto& [group, members] : groups) {
    for (const auto& [begin, end] : EvenRuns(members.size(), limit)) {
      planner.Add({members.begin() + static_cast<int64_t>(begin), members.begin() + static_cast<int64_t>(end)});
    }
  }
  return planner.Take();
}

}  // namespace oraclegs
