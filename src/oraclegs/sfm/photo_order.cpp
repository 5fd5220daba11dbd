#include "oraclegs/sfm/photo_order.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <utility>

namespace oraclegs {
namespace {

constexpr size_t kMaxPhotosAssigned = 64;  // each pair of photos is tried with each pair of poses
constexpr size_t kMaxSeeds = 200;
constexpr double kMinSeedShare = .5;
constexpr int kMaxSwaps = 50;

using Order = std::vector<int>;  // index of the pose for each photo, or for each checked view

/// Share of the matches of all pairs that fit, where each view has the pose of that number.
class OrderScore {
 public:
  explicit OrderScore(const OrderSearch& search) : search_(search), extent_(ExtentOf(search.poses)) {
    for (const RayPair& pair : search.pairs) matches_ += static_cast<double>(pair.rays_a.size());
  }

  double FitsOfPair(const RayPair& pair, int pose_a, int pose_b) {
    errors_.clear();
    const auto& poses = search_.poses;
    AppendErrors(pair, MotionBetween(poses[static_cast<size_t>(pose_a)], poses[static_cast<size_t>(pose_b)], extent_),
                 &errors_);
    return ShareBelow(errors_, search_.limit) * static_cast<double>(pair.rays_a.size());
  }

  double ShareOf(const Order& pose_of_view) {
    double fits = 0;
    for (const RayPair& pair : search_.pairs) {
      fits += FitsOfPair(pair, pose_of_view[static_cast<size_t>(pair.a)], pose_of_view[static_cast<size_t>(pair.b)]);
    }
    return matches_ > 0 ? fits / matches_ : 0;
  }

  double matches() const { return matches_; }

 private:
  const OrderSearch& search_;
  double extent_, matches_ = 0;
  std::vector<double> errors_;
};

struct NamedOrder {
  std::string words;
  Order order;
};

std::vector<NamedOrder> UsualOrders(const std::vector<std::string>& names) {
  const int n = static_cast<int>(names.size());
  std::vector<NamedOrder> orders;
  Order order(names.size());
  for (int i = 0; i < n; ++i) order[static_cast<size_t>(i)] = n - 1 - i;
  orders.push_back({"reversed", order});
  // Sorted as text, 10 comes before 2: ranks[i] is where the i-th photo stands then.
  Order by_text(names.size()), ranks(names.size());
  std::iota(by_text.begin(), by_text.end(), 0);
  std::sort(by_text.begin(), by_text.end(),
            [&](int a, int b) { return names[static_cast<size_t>(a)] < names[static_cast<size_t>(b)]; });
  for (int i = 0; i < n; ++i) ranks[static_cast<size_t>(by_text[static_cast<size_t>(i)])] = i;
  if (!std::is_sorted(ranks.begin(), ranks.end())) {
    orders.push_back({"sorted as text (10 before 2) and not as numbers", ranks});
    orders.push_back({"sorted as numbers (2 before 10) and not as text", by_text});
  }
  for (int distance = 1; distance < n; ++distance) {
    const int after = n - distance;
    for (int i = 0; i < n; ++i) order[static_cast<size_t>(i)] = (i + distance) % n;
    orders.push_back({distance <= n / 2 ? fmt::format("each pose stands {} too late", distance)
                                        : fmt::format("each pose stands {} too early", after),
                      order});
  }
  return orders;
}

/// Any order, grown from two photos whose matches fit two poses.
class Assignment {
 public:
  Assignment(const OrderSearch& search, OrderScore* score)
      : search_(search), poses_(static_cast<int>(search.poses.size())) {
    for (const RayPair& pair : search.pairs) {
      std::vector<double> fits(static_cast<size_t>(poses_ * poses_), 0);
      for (int p = 0; p < poses_; ++p) {
        for (int q = 0; q < poses_; ++q) {
          if (p != q) fits[At(p, q)] = score->FitsOfPair(pair, p, q);
        }
      }
      fits_.push_back(std::move(fits));
    }
  }

  Order Best() {
    Order best;
    double most = -1;
    for (const Seed& seed : Seeds()) {
      Order order = Grown(seed);
      const double fits = Fits(order);
      if (fits > most) most = fits, best = std::move(order);
    }
    return best.empty() ? best : Improved(std::move(best));
  }

 private:
  struct Seed {
    double share;
    size_t pair;
    int p, q;
  };

  size_t At(int p, int q) const { return static_cast<size_t>(p * poses_ + q); }

  std::vector<Seed> Seeds() const {
    std::vector<Seed> seeds;
    for (size_t k = 0; k < fits_.size(); ++k) {
      const auto matches = static_cast<double>(search_.pairs[k].rays_a.size());
      for (int p = 0; p < poses_; ++p) {
        for (int q = 0; q < poses_; ++q) {
          const double share = matches > 0 ? fits_[k][At(p, q)] / matches : 0;
          if (share >= kMinSeedShare) seeds.push_back({share, k, p, q});
        }
      }
    }
    std::stable_sort(seeds.begin(), seeds.end(), [](const Seed& a, const Seed& b) { return a.share > b.share; });
    if (seeds.size() > kMaxSeeds) seeds.resize(kMaxSeeds);
    return seeds;
  }

  /// Matches that the view of this number, with pose p, adds to those of the views that have a pose.
  double Gain(const Order& order, int view, int p) const {
    double gain = 0;
    for (size_t k = 0; k < fits_.size(); ++k) {
      const RayPair& pair = search_.pairs[k];
      if (pair.a == view && order[static_cast<size_t>(pair.b)] >= 0)
        gain += fits_[k][At(p, order[static_cast<size_t>(pair.b)])];
      if (pair.b == view && order[static_cast<size_t>(pair.a)] >= 0)
        gain += fits_[k][At(order[static_cast<size_t>(pair.a)], p)];
    }
    return gain;
  }

  Order Grown(const Seed& seed) const {
    const size_t views = search_.views.size();
    Order order(views, -1);
    std::vector<bool> taken(static_cast<size_t>(poses_), false);
    const auto assign = [&](int view, int p) {
      order[static_cast<size_t>(view)] = p;
      taken[static_cast<size_t>(p)] = true;
    };
    assign(search_.pairs[seed.pair].a, seed.p);
    assign(search_.pairs[seed.pair].b, seed.q);
    for (size_t step = 2; step < views; ++step) {
      double most = -1;
      int best_view = -1, best_pose = -1;
      for (int view = 0; view < static_cast<int>(views); ++view) {
        if (order[static_cast<size_t>(view)] >= 0) continue;
        for (int p = 0; p < poses_; ++p) {
          if (taken[static_cast<size_t>(p)]) continue;
          const double gain = Gain(order, view, p);
          if (gain > most) most = gain, best_view = view, best_pose = p;
        }
      }
      assign(best_view, best_pose);
    }
    return order;
  }

  double Fits(const Order& order) const {
    double fits = 0;
    for (size_t k = 0; k < fits_.size(); ++k) {
      const RayPair& pair = search_.pairs[k];
      fits += fits_[k][At(order[static_cast<size_t>(pair.a)], order[static_cast<size_t>(pair.b)])];
    }
    return fits;
  }

  /// Two views exchange their poses while that helps.
  Order Improved(Order order) const {
    double fits = Fits(order);
    for (int round = 0; round < kMaxSwaps; ++round) {
      bool is_better = false;
      for (size_t i = 0; i < order.size(); ++i) {
        for (size_t j = i + 1; j < order.size(); ++j) {
          std::swap(order[i], order[j]);
          const double now = Fits(order);
          if (now > fits) {
            fits = now, is_better = true;
          } else {
            std::swap(order[i], order[j]);
          }
        }
      }
      if (!is_better) break;
    }
    return order;
  }

  const OrderSearch& search_;
  int poses_;
  std::vector<std::vector<double>> fits_;  ///< fits of each pair, by the poses of its two views
};

}  // namespace

std::optional<PhotoOrder> FindPhotoOrder(const OrderSearch& search) {
  if (search.pairs.empty() || search.poses.size() < 2) return std::nullopt;
  OrderScore score(search);
  const double given = score.ShareOf(search.views);
  PhotoOrder best{{}, "", given};
  for (const NamedOrder& named : UsualOrders(search.names)) {
    Order of_views;
    for (const int view : search.views) of_views.push_back(named.order[static_cast<size_t>(view)]);
    const double share = score.ShareOf(of_views);
    if (share > best.share) best = {std::move(of_views), named.words, share};
  }
  constexpr double kClearly = .05;  // an order without a name has more freedom to fit by chance
  if (search.poses.size() <= kMaxPhotosAssigned) {
    Order order = Assignment(search, &score).Best();
    const double share = order.empty() ? 0 : score.ShareOf(order);
    if (share > best.share + kClearly) best = {std::move(order), "", share};
  }
  if (best.share <= given || best.pose_of_view.empty()) return std::nullopt;
  return best;
}

}  // namespace oraclegs
