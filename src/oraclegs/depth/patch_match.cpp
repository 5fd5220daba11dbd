#include "oraclegs/depth/patch_match.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "oraclegs/core/parallel.h"
#include "oraclegs/core/rng.h"

namespace oraclegs {
namespace {

constexpr uint64_t kSeed = 0;  // depth does not depend on a run's seed, so that runs of several seeds can share it
constexpr int kRowsPerTask = 2;
constexpr int kDirections = 8;                // regions that hand a plane on
constexpr int kRefinements = 6;               // random planes a pixel and iteration
constexpr int kHypotheses = kDirections + 1;  // with the pixel's own
constexpr int kMaxSources = 8;
constexpr float kLeastCosine = 0.0523f;  // between normal and viewing ray: 87 degrees
constexpr float kSteepest = 4;           // tangent of the tilt that random planes reach
constexpr float kGoodCost = 0.8f, kBadCost = 1.2f, kCostSigma = 0.3f;
constexpr int kEnoughGood = 3, kTooManyBad = 3;                // of the hypotheses, for a view to be trusted
constexpr float kGeometricWeight = 0.1f, kGeometricLimit = 3;  // cost per pixel of round trip, pixels

/// Numbers of one pixel in one iteration.
class PixelRandom {
 public:
  PixelRandom(uint64_t seed, uint64_t counter) : seed_(seed), counter_(counter) {}

  /// [-1, 1)
  float Signed() {
    if (used_ == 4) {
      words_ = Philox::Draw(seed_, static_cast<uint64_t>(RandomStream::kStereo) | draws_++ << 32, counter_);
      used_ = 0;
    }
    return static_cast<float>(words_.x[used_++] >> 8) * 0x1.0p-23f - 1;
  }
  /// [0, 1)
  float Unit() { return 0.5f * Signed() + 0.5f; }

 private:
  uint64_t seed_, counter_, draws_ = 0;
  Philox words_{};
  int used_ = 4;
};

uint64_t CounterOf(size_t view, int pass, int iteration, size_t pixel) {
  return ((static_cast<uint64_t>(view) * 64 + static_cast<uint64_t>(pass)) * 64 + static_cast<uint64_t>(iteration))
             << 32 |
         pixel;
}

float RandomInverseDepth(const DepthRange& range, PixelRandom* random) {
  return range.far + (range.near - range.far) * random->Unit();
}

/// Gives the plane a random tilt, even in the angle's tangent.
void Tilt(const Camera& camera, PixelRandom* random, Plane* plane) {
  const float tangent = kSteepest * random->Unit() * random->Unit(),
              angle = static_cast<float>(M_PI) * random->Signed();
  plane->dx = plane->inv_depth * tangent * std::cos(angle) / static_cast<float>(camera.fx);
  plane->dy = plane->inv_depth * tangent * std::sin(angle) / static_cast<float>(camera.fy);
}

/// The search of one pass over one view.
class Pass {
 public:
  Pass(const StereoScene& scene, size_t view, const PassOptions& options, PlaneMap* map)
      : scene_(scene), view_(scene.views[view]), view_index_(view), options_(options), map_(*map) {
    for (const int n : view_.neighbors) {
      if (static_cast<int>(sources_.size()) == kMaxSources) break;
      const StereoView& other = scene.views[static_cast<size_t>(n)];
      sources_.push_back({&other.image, MapBetween(view_.camera, other.camera)});
      back_.push_back(MapBetween(other.camera, view_.camera));
      if (options.geometry != nullptr) geometry_.push_back(&(*options.geometry)[static_cast<size_t>(n)]);
    }
    if (scene.silhouettes == nullptr || scene.silhouettes->empty()) return;
    for (size_t v = 0; v < scene.views.size(); ++v) hull_.push_back(MapBetween(view_.camera, scene.views[v].camera));
  }

  void Run() {
    if (sources_.empty()) return;
    const int rows = (map_.height + kRowsPerTask - 1) / kRowsPerTask;
    for (iteration_ = 0; iteration_ < options_.iterations; ++iteration_) {
      for (int color = 0; color < 2; ++color) {
        ParallelFor(rows, [&](int64_t task) {
          const int begin = static_cast<int>(task) * kRowsPerTask;
          for (int y = begin; y < std::min(map_.height, begin + kRowsPerTask); ++y) {
            for (int x = (y + color) % 2; x < map_.width; x += 2) Improve(x, y);
          }
        });
      }
    }
  }

 private:
  using Costs = std::array<float, kHypotheses * kMaxSources>;

  size_t Index(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(map_.width) + static_cast<size_t>(x);
  }

  /// The plane another pixel knows, as seen from (x, y).
  Plane Carried(int from_x, int from_y, int x, int y) const {
    const Plane& p = map_.At(from_x, from_y);
    return {p.At(static_cast<float>(x - from_x), static_cast<float>(y - from_y)), p.dx, p.dy};
  }

  bool IsAllowed(const Plane& plane, float u, float v) const {
    if (!(plane.inv_depth >= view_.range.far && plane.inv_depth <= view_.range.near)) return false;
    const Eigen::Vector3f ray = RayOf(view_.camera, u, v);
    if (-NormalOf(view_.camera, plane, u, v).dot(ray) < kLeastCosine * ray.norm()) return false;
    for (size_t other = 0; other < hull_.size(); ++other) {
      if (other == view_index_) continue;
      const Eigen::Vector3f q = hull_[other](u, v, plane.inv_depth);
      if (!(q.z() > 0)) continue;
      if (!scene_.silhouettes->MayContain(other, scene_.silhouette_scale * q.x() / q.z(),
                                          scene_.silhouette_scale * q.y() / q.z())) {
        return false;
      }
    }
    return true;
  }

  /// The cheapest plane among one region's pixels, by what it cost its owner.
  template <size_t n>
  void AddBest(int x, int y, const std::array<std::array<int, 2>, n>& region, std::array<int, 2> axis,
               std::vector<Plane>* out) const {
    float best = std::numeric_limits<float>::infinity();
    int best_x = 0, best_y = 0;
    for (const auto& [along, across] : region) {
      const int nx = x + along * axis[0] - across * axis[1], ny = y + along * axis[1] + across * axis[0];
      if (nx < 0 || ny < 0 || nx >= map_.width || ny >= map_.height) continue;
      const float cost = map_.costs[Index(nx, ny)];
      if (map_.At(nx, ny).inv_depth > 0 && cost < best) {
        best = cost;
        best_x = nx, best_y = ny;
      }
    }
    if (best < std::numeric_limits<float>::infinity()) out->push_back(Carried(best_x, best_y, x, y));
  }

  /// Planes of the eight regions around a pixel: in each direction a near fan and a far strip.
  void Propagated(int x, int y, std::vector<Plane>* out) const {
    static constexpr std::array<std::array<int, 2>, 7> kFan{
        {{1, 0}, {2, -1}, {2, 1}, {3, -2}, {3, 2}, {4, -3}, {4, 3}}};
    static constexpr std::array<std::array<int, 2>, 11> kStrip{
        {{3, 0}, {5, 0}, {7, 0}, {9, 0}, {11, 0}, {13, 0}, {15, 0}, {17, 0}, {19, 0}, {21, 0}, {23, 0}}};
    for (const std::array<int, 2> axis : {std::array{1, 0}, std::array{-1, 0}, std::array{0, 1}, std::array{0, -1}}) {
      AddBest(x, y, kFan, axis, out);
      AddBest(x, y, kStrip, axis, out);
    }
  }

  /// What a source thinks of a plane beyond its pixels: how far a round trip over its own depth ends from the start.
  float GeometricCost(size_t source, float u, float v, float inv_depth) const {
    if (geometry_.empty()) return 0;
    const RoundTrip trip = GoAndReturn(sources_[source].map, back_[source], *geometry_[source], {u, v, inv_depth});
    return kGeometricWeight * (trip.seen ? std::min(trip.pixels, kGeometricLimit) : kGeometricLimit);
  }

  /// How far each source is to be believed at this pixel: one that most hypotheses fail in is probably hidden.
  void WeighSources(const Costs& costs, int hypotheses, float* weights) const {
    const size_t n = sources_.size();
    const float good_cost = kGoodCost * std::exp(-static_cast<float>(iteration_ * iteration_) / 90);
    float total = 0;
    for (size_t s = 0; s < n; ++s) {
      int good = 0, bad = 0;
      float belief = 0;
      for (int h = 0; h < hypotheses; ++h) {
        const float cost = costs[static_cast<size_t>(h) * n + s];
        bad += cost > kBadCost ? 1 : 0;
        if (!(cost < good_cost)) continue;
        ++good;
        belief += std::exp(-cost * cost / (2 * kCostSigma * kCostSigma));
      }
      weights[s] =
          good >= std::min(kEnoughGood, hypotheses) && bad < kTooManyBad ? belief / static_cast<float>(good) : 0;
      total += weights[s];
    }
    if (total > 0) return;
    // Nobody is good: all take part, the likelier the more. A random plane may be the first that falls into a picture.
    for (size_t s = 0; s < n; ++s) {
      float best = kWorstCost;
      for (int h = 0; h < hypotheses; ++h) best = std::min(best, costs[static_cast<size_t>(h) * n + s]);
      weights[s] = std::exp(-best * best / (2 * kCostSigma * kCostSigma)) + 1e-6f;
    }
  }

  void Improve(int x, int y) {
    const size_t pixel = Index(x, y);
    if (!view_.usable.empty() && view_.usable[pixel] == 0) return;
    const Patch patch = MakePatch(view_.image, x, y, view_.usable.empty() ? nullptr : view_.usable.data());
    const size_t n = sources_.size();
    thread_local std::vector<Plane> planes;
    planes.clear();
    planes.push_back(map_.planes[pixel]);
    Propagated(x, y, &planes);
    planes.erase(std::remove_if(planes.begin() + 1, planes.end(),
                                [&](const Plane& p) { return !IsAllowed(p, patch.u, patch.v); }),
                 planes.end());
    Costs costs;
    std::array<uint8_t, kMaxSources> active;
    active.fill(1);
    const int count = static_cast<int>(planes.size());
    PatchCosts(patch, sources_.data(), active.data(), static_cast<int>(n), planes.data(), count, costs.data());
    std::array<float, kMaxSources> weights{};
    WeighSources(costs, count, weights.data());
    for (size_t s = 0; s < n; ++s) active[s] = weights[s] > 0 ? 1 : 0;

    Choice best;
    const bool own_is_allowed = IsAllowed(planes[0], patch.u, patch.v);
    for (int h = own_is_allowed ? 0 : 1; h < count; ++h) {
      Consider(planes[static_cast<size_t>(h)], costs.data() + static_cast<size_t>(h) * n, weights, patch, &best);
    }
    if (!(best.score < std::numeric_limits<float>::infinity())) {
      best.plane = planes[0];
      best.photometric = kWorstCost;
    }
    Refine(patch, pixel, weights, active, &best);
    map_.planes[pixel] = best.plane;
    map_.costs[pixel] = best.photometric;
  }

  struct Choice {
    Plane plane;
    float score = std::numeric_limits<float>::infinity();  ///< with the geometric term
    float photometric = kWorstCost;
  };

  void Consider(const Plane& plane, const float* costs, const std::array<float, kMaxSources>& weights,
                const Patch& patch, Choice* best) const {
    float photometric = 0, score = 0, total = 0;
    for (size_t s = 0; s < sources_.size(); ++s) {
      if (!(weights[s] > 0)) continue;
      photometric += weights[s] * costs[s];
      score += weights[s] * (costs[s] + GeometricCost(s, patch.u, patch.v, plane.inv_depth));
      total += weights[s];
    }
    if (!(total > 0) || !(score / total < best->score)) return;
    *best = {plane, score / total, photometric / total};
  }

  void Refine(const Patch& patch, size_t pixel, const std::array<float, kMaxSources>& weights,
              const std::array<uint8_t, kMaxSources>& active, Choice* best) const {
    PixelRandom random(kSeed, CounterOf(view_index_, options_.pass, iteration_, pixel));
    Plane start = best->plane;
    if (!(start.inv_depth > 0)) start = {RandomInverseDepth(view_.range, &random), 0, 0};
    const float fx = static_cast<float>(view_.camera.fx), fy = static_cast<float>(view_.camera.fy);
    std::array<Plane, kRefinements> planes;
    int count = 0;
    const auto add = [&](const Plane& plane) {
      if (IsAllowed(plane, patch.u, patch.v)) planes[static_cast<size_t>(count++)] = plane;
    };
    const auto near_depth = [&] {
      const float step = std::exp2(-5 - 4 * random.Unit());  // 3 % to 0.2 %
      return start.inv_depth * (1 + step * random.Signed());
    };
    const auto near_tilt = [&](Plane* plane) {
      const float step = std::exp2(-1 - 3 * random.Unit());
      plane->dx = start.dx + plane->inv_depth * step * random.Signed() / fx;
      plane->dy = start.dy + plane->inv_depth * step * random.Signed() / fy;
    };
    Plane plane = start;  // elsewhere, as tilted as now
    plane.inv_depth = RandomInverseDepth(view_.range, &random);
    const float ratio = plane.inv_depth / start.inv_depth;
    plane.dx *= ratio, plane.dy *= ratio;
    add(plane);
    plane.inv_depth = RandomInverseDepth(view_.range, &random);  // anything
    Tilt(view_.camera, &random, &plane);
    add(plane);
    plane = start;  // here, tilted anew
    Tilt(view_.camera, &random, &plane);
    add(plane);
    plane = start;  // a little nearer or farther
    plane.inv_depth = near_depth();
    add(plane);
    plane = start;  // a little turned
    near_tilt(&plane);
    add(plane);
    plane.inv_depth = near_depth();  // both
    near_tilt(&plane);
    add(plane);
    if (count == 0) return;
    Costs costs;
    const size_t n = sources_.size();
    PatchCosts(patch, sources_.data(), active.data(), static_cast<int>(n), planes.data(), count, costs.data());
    for (int h = 0; h < count; ++h) {
      Consider(planes[static_cast<size_t>(h)], costs.data() + static_cast<size_t>(h) * n, weights, patch, best);
    }
  }

  const StereoScene& scene_;
  const StereoView& view_;
  size_t view_index_;
  const PassOptions& options_;
  PlaneMap& map_;
  std::vector<PatchSource> sources_;
  std::vector<PixelMap> back_, hull_;
  std::vector<const PlaneMap*> geometry_;
  int iteration_ = 0;
};

}  // namespace

PlaneMap RandomPlanes(const StereoScene& scene, size_t view, const std::vector<float>& hints) {
  const StereoView& v = scene.views[view];
  PlaneMap map{v.camera.width, v.camera.height, {}, {}};
  const size_t pixels = static_cast<size_t>(map.width) * static_cast<size_t>(map.height);
  map.planes.resize(pixels);
  map.costs.assign(pixels, kWorstCost);
  constexpr int kStartPass = 63;  // beyond the passes of a run
  for (size_t i = 0; i < pixels; ++i) {
    if (!v.usable.empty() && v.usable[i] == 0) continue;
    PixelRandom random(kSeed, CounterOf(view, kStartPass, 0, i));
    if (!hints.empty() && hints[i] > 0) {
      map.planes[i] = {hints[i], 0, 0};
      continue;
    }
    map.planes[i].inv_depth = RandomInverseDepth(v.range, &random);
    Tilt(v.camera, &random, &map.planes[i]);
  }
  return map;
}

PlaneMap Resized(const PlaneMap& map, int width, int height) {
  PlaneMap out{width, height, {}, {}};
  const float sx = static_cast<float>(map.width) / static_cast<float>(width);
  const float sy = static_cast<float>(map.height) / static_cast<float>(height);
  out.planes.reserve(static_cast<size_t>(width) * height);
  out.costs.reserve(out.planes.capacity());
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float u = (static_cast<float>(x) + 0.5f) * sx, v = (static_cast<float>(y) + 0.5f) * sy;
      const int ox = std::min(static_cast<int>(u), map.width - 1), oy = std::min(static_cast<int>(v), map.height - 1);
      const Plane& p = map.At(ox, oy);
      const float at = p.At(u - static_cast<float>(ox) - 0.5f, v - static_cast<float>(oy) - 0.5f);
      out.planes.push_back({std::max(at, 0.f), p.dx * sx, p.dy * sy});
      out.costs.push_back(map.costs[static_cast<size_t>(oy) * map.width + ox]);
    }
  }
  return out;
}

void RunPass(const StereoScene& scene, size_t view, const PassOptions& options, PlaneMap* map) {
  Pass(scene, view, options, map).Run();
}

RoundTrip GoAndReturn(const PixelMap& there, const PixelMap& back, const PlaneMap& other, const Eigen::Vector3f& uvw) {
  const Eigen::Vector3f q = there(uvw.x(), uvw.y(), uvw.z());
  if (!(q.z() > 0)) return {};
  const float u = q.x() / q.z(), v = q.y() / q.z();
  if (!(u >= 0 && v >= 0 && u < static_cast<float>(other.width) && v < static_cast<float>(other.height))) return {};
  const int x = static_cast<int>(u), y = static_cast<int>(v);
  const Plane& plane = other.At(x, y);
  if (!(plane.inv_depth > 0)) return {};
  const float known = plane.At(u - static_cast<float>(x) - 0.5f, v - static_cast<float>(y) - 0.5f);
  if (!(known > 0)) return {};
  const Eigen::Vector3f r = back(u, v, known);
  if (!(r.z() > 0)) return {};
  const float du = r.x() / r.z() - uvw.x(), dv = r.y() / r.z() - uvw.y();
  return {true, std::sqrt(du * du + dv * dv), q.z() / uvw.z() * known - 1};
}

}  // namespace oraclegs
