#include "oraclegs/validate/view_chunks.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <tuple>

#include "oraclegs/core/error.h"
#include "oraclegs/propose/nearest_order.h"

namespace oraclegs {
namespace {

/// Mean distance of the photographs from their centre.
double SpreadOf(const std::vector<LoadedView>& photos) {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const LoadedView& photo : photos) centre += photo.camera.Center() / static_cast<double>(photos.size());
  double spread = 0;
  for (const LoadedView& photo : photos) {
    spread += (photo.camera.Center() - centre).norm() / static_cast<double>(photos.size());
  }
  return std::max(spread, 1e-9);
}

class Planner {
 public:
  Planner(const std::vector<HiddenPhotograph>& hidden, const std::vector<LoadedView>& photos)
      : hidden_(hidden), photos_(photos), spread_(photos.empty() ? 1 : SpreadOf(photos)) {}

  void Add(std::vector<size_t> members) {
    if (const auto reference = Nearest(members)) {
      chunks_.push_back({std::move(members), *reference});
      return;
    }
    if (members.size() == 1) {
      throw InputError(
          "{}: VGGT has no photograph to compare it with, for the only one is hidden; give more training photographs, "
          "or "
          "use --oracle consistency",
          hidden_[members[0]].proposal.name);
    }
    const auto half = members.begin() + static_cast<int64_t>(members.size() / 2);
    Add({members.begin(), half});
    Add({half, members.end()});
  }

  std::vector<ViewChunk> Take() { return std::move(chunks_); }

 private:
  std::optional<size_t> Nearest(const std::vector<size_t>& members) const {
    std::set<int> taken;
    for (const size_t m : members) taken.insert(hidden_[m].photograph);
    const Camera& size = hidden_[members[0]].proposal.camera;
    std::optional<size_t> best;
    std::pair<bool, double> lowest;
    for (size_t p = 0; p < photos_.size(); ++p) {
      if (taken.count(static_cast<int>(p)) > 0) continue;
      const Camera& camera = photos_[p].camera;
      std::pair<bool, double> cost = {camera.width != size.width || camera.height != size.height, 0};
      for (const size_t m : members) {
        const Camera& other = hidden_[m].proposal.camera;
        cost.second += (camera.Center() - other.Center()).norm() / spread_ + TurnBetween(camera, other);
      }
      if (best && !(cost < lowest)) continue;
      best = p, lowest = cost;
    }
    return best;
  }

  const std::vector<HiddenPhotograph>& hidden_;
  const std::vector<LoadedView>& photos_;
  double spread_;
  std::vector<ViewChunk> chunks_;
};

}  // namespace

std::vector<std::pair<size_t, size_t>> EvenRuns(size_t count, size_t most) {
  std::vector<std::pair<size_t, size_t>> runs;
  const size_t number = (count + std::max<size_t>(most, 1) - 1) / std::max<size_t>(most, 1);
  for (size_t r = 0; r < number; ++r) runs.emplace_back(r * count / number, (r + 1) * count / number);
  return runs;
}

std::vector<ViewChunk> PlanChunks(const std::vector<HiddenPhotograph>& hidden, const std::vector<LoadedView>& photos,
                                  size_t most) {
  std::map<std::tuple<std::string, int, int>, std::vector<size_t>> groups;
  for (size_t h = 0; h < hidden.size(); ++h) {
    const Proposal& p = hidden[h].proposal;
    groups[{p.source, p.camera.width, p.camera.height}].push_back(h);
  }
  Planner planner(hidden, photos);
  for (const auto& [group, members] : groups) {
    for (const auto& [begin, end] : EvenRuns(members.size(), most)) {
      planner.Add({members.begin() + static_cast<int64_t>(begin), members.begin() + static_cast<int64_t>(end)});
    }
  }
  return planner.Take();
}

}  // namespace oraclegs
