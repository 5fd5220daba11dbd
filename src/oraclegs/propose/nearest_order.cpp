#include "oraclegs/propose/nearest_order.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace oraclegs {
namespace {

constexpr double kTurnShare = 0.1;
constexpr size_t kMaxStarts = 16;
constexpr int kMaxSweeps = 30;

class Distances {
 public:
  explicit Distances(const std::vector<Camera>& cameras) : count_(cameras.size()), values_(count_ * count_) {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const Camera& c : cameras) mean += c.Center() / static_cast<double>(count_);
    double spread = 0;
    for (const Camera& c : cameras) spread += (c.Center() - mean).norm() / static_cast<double>(count_);
    const double turn_cost = spread > 0 ? kTurnShare * spread : 1;
    for (size_t i = 0; i < count_; ++i) {
      for (size_t j = 0; j < count_; ++j) {
        values_[i * count_ + j] =
            (cameras[i].Center() - cameras[j].Center()).norm() + turn_cost * TurnBetween(cameras[i], cameras[j]);
      }
    }
  }
  size_t count() const { return count_; }
  double operator()(size_t i, size_t j) const { return values_[i * count_ + j]; }

 private:
  size_t count_;
  std::vector<double> values_;
};

std::vector<size_t> GreedyFrom(size_t start, const Distances& distance) {
  std::vector<size_t> order{start};
  std::vector<bool> used(distance.count(), false);
  used[start] = true;
  while (order.size() < distance.count()) {
    size_t nearest = distance.count();
    for (size_t j = 0; j < distance.count(); ++j) {
      if (!used[j] && (nearest == distance.count() || distance(order.back(), j) < distance(order.back(), nearest)))
        nearest = j;
    }
    used[nearest] = true;
    order.push_back(nearest);
  }
  return order;
}

/// Reverses parts of the order as long as that makes the path shorter (2-opt).
void UndoCrossings(const Distances& distance, std::vector<size_t>* order) {
  const std::vector<size_t>& o = *order;
  const size_t n = o.size();
  for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
    bool shorter = false;
    for (size_t i = 0; i + 1 < n; ++i) {
      for (size_t j = i + 1; j < n; ++j) {
        double gain = 0;  // of reversing i .. j; the ends of the path are free
        if (i > 0) gain += distance(o[i - 1], o[i]) - distance(o[i - 1], o[j]);
        if (j + 1 < n) gain += distance(o[j], o[j + 1]) - distance(o[i], o[j + 1]);
        if (gain <= 1e-12 * distance(o[i], o[j])) continue;
        std::reverse(order->begin() + static_cast<std::ptrdiff_t>(i),
                     order->begin() + static_cast<std::ptrdiff_t>(j) + 1);
        shorter = true;
      }
    }
    if (!shorter) return;
  }
}

}  // namespace

std::vector<size_t> NearestOrder(const std::vector<Camera>& cameras) {
  const Distances distance(cameras);
  std::vector<size_t> best;
  double shortest = std::numeric_limits<double>::infinity();
  const size_t starts = std::min(kMaxStarts, cameras.size());
  for (size_t s = 0; s < starts; ++s) {
    std::vector<size_t> order = GreedyFrom(s * cameras.size() / starts, distance);
    UndoCrossings(distance, &order);
    double length = 0;
    for (size_t i = 0; i + 1 < order.size(); ++i) length += distance(order[i], order[i + 1]);
    if (length >= shortest) continue;
    shortest = length;
    best = std::move(order);
  }
  return best;
}

}  // namespace oraclegs
