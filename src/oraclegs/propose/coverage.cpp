#include "oraclegs/propose/trajectory.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "oraclegs/core/parallel.h"
#include "oraclegs/core/statistics.h"
#include "oraclegs/propose/target_check.h"

namespace oraclegs {
namespace {

constexpr float kNewAngle = 10 * std::numbers::pi_v<float> / 180;
constexpr size_t kOpennessPoints = 4000;
constexpr double kNothing = 1e-6;  // points: what the sums of gains round

/// Weight of a point. cosine: of the angle between the camera's direction to it and the nearest one so far.
double Newness(float cosine) { return 1 - std::exp(-std::acos(std::clamp(cosine, -1.f, 1.f)) / kNewAngle); }

/// Points that a camera sees, with their directions.
struct View {
  std::vector<int> seen;                    // ascending
  std::vector<Eigen::Vector3f> directions;  // from the camera to each of them, unit
  std::vector<float> cosines;               // of each to the nearest direction from which it was seen so far
  double gain = 0;
  size_t compared = 0;  // chosen views that `gain` accounts for
};

View ViewOf(const std::vector<DensePoint>& points, const Camera& camera) {
  View view;
  view.seen = PointsSeen(points, camera);
  const Eigen::Vector3f center = camera.Center().cast<float>();
  for (const int p : view.seen) {
    view.directions.push_back((points[static_cast<size_t>(p)].xyz - center).normalized());
  }
  view.cosines.assign(view.seen.size(), -1);
  view.gain = static_cast<double>(view.seen.size()) * Newness(-1);
  return view;
}

/// Lowers the gain of `view` for points that `other` saw from a nearer direction than any view before.
void Account(const View& other, View* view) {
  size_t j = 0;
  for (size_t i = 0; i < view->seen.size(); ++i) {
    while (j < other.seen.size() && other.seen[j] < view->seen[i]) ++j;
    if (j == other.seen.size()) return;
    if (other.seen[j] != view->seen[i]) continue;
    const float cosine = view->directions[i].dot(other.directions[j]);
    if (cosine <= view->cosines[i]) continue;
    view->gain += Newness(cosine) - Newness(view->cosines[i]);
    view->cosines[i] = cosine;
  }
}

}  // namespace

double Openness(const std::vector<DensePoint>& points, const std::vector<Camera>& train) {
  const std::vector<DensePoint> sample = EvenSample(points, kOpennessPoints);
  std::vector<View> views(train.size());
  ParallelFor(static_cast<int64_t>(train.size()),
              [&](int64_t v) { views[static_cast<size_t>(v)] = ViewOf(sample, train[static_cast<size_t>(v)]); });
  std::vector<double> newness(train.size(), 1);
  ParallelFor(static_cast<int64_t>(train.size()), [&](int64_t task) {
    const auto v = static_cast<size_t>(task);
    View view = views[v];
    for (size_t other = 0; other < views.size(); ++other) {
      if (other != v) Account(views[other], &view);
    }
    if (!view.seen.empty()) newness[v] = view.gain / static_cast<double>(view.seen.size());
  });
  return newness.empty() ? 1 : UpperMedian(&newness);
}

std::vector<size_t> ChooseByCoverage(const std::vector<DensePoint>& points, const std::vector<Camera>& train,
                                     const std::vector<Camera>& candidates, int count) {
  std::vector<View> known(train.size()), views(candidates.size());
  ParallelFor(static_cast<int64_t>(train.size()),
              [&](int64_t i) { known[static_cast<size_t>(i)] = ViewOf(points, train[static_cast<size_t>(i)]); });
  ParallelFor(static_cast<int64_t>(candidates.size()), [&](int64_t task) {
    View& view = views[static_cast<size_t>(task)];
    view = ViewOf(points, candidates[static_cast<size_t>(task)]);
    for (const View& k : known) Account(k, &view);
  });
  // Gains only shrink as more is chosen: the largest one that is up to date is the largest of all.
  std::vector<size_t> chosen;
  std::vector<bool> taken(candidates.size(), false);
  while (static_cast<int>(chosen.size()) < count) {
    size_t best = candidates.size();
    for (size_t i = 0; i < views.size(); ++i) {
      if (!taken[i] && (best == candidates.size() || views[i].gain > views[best].gain)) best = i;
    }
    if (best == candidates.size() || !(views[best].gain > kNothing)) break;
    View& view = views[best];
    if (view.compared == chosen.size()) {
      taken[best] = true;
      chosen.push_back(best);
      continue;
    }
    for (; view.compared < chosen.size(); ++view.compared) Account(views[chosen[view.compared]], &view);
  }
  return chosen;
}

}  // namespace oraclegs
