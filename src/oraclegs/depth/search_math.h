#pragma once
// The search for a pixel's plane (docs/method.md#stereo), for host and device: the planes to try, which of them are
// allowed, the weights of source views. The caller compares the patches.

#include <cmath>
#include <cstdint>
#include <limits>

#include "oraclegs/core/device_macros.h"
#include "oraclegs/core/rng.h"
#include "oraclegs/depth/plane_math.h"
#include "oraclegs/depth/silhouette_mask.h"

namespace oraclegs {

inline constexpr uint64_t kStereoSeed = 0;  // depth does not depend on a run's seed: runs of several seeds can share it
inline constexpr int kRegions = 8;  // whose planes are propagated: in each of four directions a near fan, a far strip
inline constexpr int kFanPixels = 7, kStripPixels = 11;
inline constexpr int kHypotheses = kRegions + 1;  // with the pixel's own
inline constexpr int kRefinements = 6;            // random planes a pixel and iteration
inline constexpr int kFirstLocal = 3;             // of them that change a plane a little
inline constexpr int kMaxSources = 8;
inline constexpr float kMinCosine = 0.0523f;  // between normal and viewing ray: 87 degrees
inline constexpr float kMaxTilt = 4;          // tangent of the tilt that random planes reach
inline constexpr float kGoodCost = 0.8f, kBadCost = 1.2f, kCostSigma = 0.3f;
inline constexpr int kMinGood = 3, kMaxBad = 3;  // of the hypotheses, for a source view to contribute
inline constexpr float kGeometricWeight = 0.1f, kGeometricLimit = 3;  // cost per pixel of round trip, pixels

/// A source view.
struct SearchSource {
  PlainPixelMap there, back;
  KnownPlanes known;  ///< planes after the pass before; without planes there is no geometric term
};

/// A view with the object's silhouette, outside of which no plane is allowed.
struct SearchSilhouette {
  PlainPixelMap there;
  SilhouetteMask mask;
};

/// One view with all inputs and outputs of its search. Pointers are to the memory of the searching device.
struct SearchView {
  int width = 0, height = 0;
  float fx = 0, fy = 0, cx = 0, cy = 0;
  float far = 0, near = 0;          ///< bounds of inverse depth
  int view = 0, pass = 0;           ///< keys of the random numbers, with the iteration
  bool local = false;               ///< as SearchPass::local
  const uint8_t* usable = nullptr;  ///< height * width; null: all usable
  Plane* planes = nullptr;          ///< height * width
  float* costs = nullptr;           ///< height * width
  int num_sources = 0, num_silhouettes = 0;
  SearchSource sources[kMaxSources];
  const SearchSilhouette* silhouettes = nullptr;
  float silhouette_scale = 1;  ///< silhouette pixels per image pixel

  ORACLEGS_HD inline int64_t Index(int x, int y) const { return static_cast<int64_t>(y) * width + x; }
  ORACLEGS_HD inline bool IsUsable(int x, int y) const { return usable == nullptr || usable[Index(x, y)] != 0; }
};

/// Random numbers of one pixel in one iteration.
class PixelRandom {
 public:
  ORACLEGS_HD inline PixelRandom(const SearchView& view, int iteration, int64_t pixel)
      : counter_(((static_cast<uint64_t>(view.view) * 64 + static_cast<uint64_t>(view.pass)) * 64 +
                  static_cast<uint64_t>(iteration))
                     << 32 |
                 static_cast<uint64_t>(pixel)) {}

  /// Uniform in [-1, 1).
  ORACLEGS_HD inline float Signed() {
    if (used_ == 4) {
      words_ = Philox::Draw(kStereoSeed, static_cast<uint64_t>(RandomStream::kStereo) | draws_++ << 32, counter_);
      used_ = 0;
    }
    return static_cast<float>(words_.x[used_++] >> 8) * 0x1.0p-23f - 1;
  }
  /// Uniform in [0, 1).
  ORACLEGS_HD inline float Unit() { return 0.5f * Signed() + 0.5f; }

 private:
  uint64_t counter_, draws_ = 0;
  Philox words_{};
  int used_ = 4;
};

ORACLEGS_HD inline float RandomInverseDepth(const SearchView& view, PixelRandom* random) {
  return view.far + (view.near - view.far) * random->Unit();
}

/// Gives the plane a random tilt, uniform in the tangent of the angle.
ORACLEGS_HD inline void Tilt(const SearchView& view, PixelRandom* random, Plane* plane) {
  const float tangent = kMaxTilt * random->Unit() * random->Unit();
  const float angle = 3.14159265f * random->Signed();
  plane->dx = plane->inv_depth * tangent * std::cos(angle) / view.fx;
  plane->dy = plane->inv_depth * tangent * std::sin(angle) / view.fy;
}

/// The search at one usable pixel, in one iteration. CostsOf(planes, count, active, costs) fills
/// costs[p * num_sources + s] as PatchCosts does (patch_cost.h).
template <class CostsOf>
class PixelSearch {
 public:
  ORACLEGS_HD inline PixelSearch(const SearchView& view, int x, int y, const CostsOf& costs_of)
      : view_(view),
        costs_of_(costs_of),
        x_(x),
        y_(y),
        u_(static_cast<float>(x) + 0.5f),
        v_(static_cast<float>(y) + 0.5f) {}

  /// Improves the pixel's plane and cost. Reads planes of pixels of the other color only.
  ORACLEGS_HD inline void Improve(int iteration) {
    const int64_t pixel = view_.Index(x_, y_);
    const Plane own = view_.planes[pixel];
    Plane planes[kHypotheses];
    planes[0] = own;
    int count = 1;
    for (int region = 0; region < kRegions; ++region) {
      if (view_.local && IsStrip(region)) continue;
      Plane plane;
      if (BestOf(region, &plane) && IsAllowed(plane)) planes[count++] = plane;
    }
    for (uint8_t& active : active_) active = 1;
    costs_of_(planes, count, active_, costs_);
    WeighSources(iteration, count);
    for (int s = 0; s < view_.num_sources; ++s) active_[s] = weights_[s] > 0 ? 1 : 0;
    for (int h = IsAllowed(own) ? 0 : 1; h < count; ++h) Consider(planes[h], costs_ + h * view_.num_sources);
    if (!(best_score_ < std::numeric_limits<float>::infinity())) best_ = own;
    Refine(iteration, pixel);
    view_.planes[pixel] = best_;
    view_.costs[pixel] = best_cost_;
  }

 private:
  ORACLEGS_HD inline bool IsAllowed(const Plane& plane) const {
    if (!(plane.inv_depth >= view_.far && plane.inv_depth <= view_.near)) return false;
    // Direction away from the camera, as NormalOf (plane.cpp) explains.
    Vec3f away{plane.dx * view_.fx, plane.dy * view_.fy, plane.At(view_.cx - u_, view_.cy - v_)};
    const float norm = std::sqrt(Dot(away, away));
    if (norm > 0) away.x /= norm, away.y /= norm, away.z /= norm;
    const Vec3f ray{(u_ - view_.cx) / view_.fx, (v_ - view_.cy) / view_.fy, 1};
    if (Dot(away, ray) < kMinCosine * std::sqrt(Dot(ray, ray))) return false;
    for (int k = 0; k < view_.num_silhouettes; ++k) {
      const SearchSilhouette& silhouette = view_.silhouettes[k];
      const Vec3f q = silhouette.there(u_, v_, plane.inv_depth);
      if (!(q.z > 0)) continue;
      const float scale = view_.silhouette_scale;
      if (!silhouette.mask.MayContain(scale * q.x / q.z, scale * q.y / q.z)) return false;
    }
    return true;
  }

  ORACLEGS_HD inline static bool IsStrip(int region) { return region % 2 == 1; }

  /// Finds the plane of least cost among one region's pixels, by its owner's cost, as seen from this pixel.
  ORACLEGS_HD inline bool BestOf(int region, Plane* plane) const {
    const int direction = region / 2;  // right, left, down, up
    const int right = direction == 0 ? 1 : direction == 1 ? -1 : 0, down = direction == 2 ? 1 : direction == 3 ? -1 : 0;
    const bool is_strip = IsStrip(region);
    float best = std::numeric_limits<float>::infinity();
    int best_x = 0, best_y = 0;
    for (int k = 0; k < (is_strip ? kStripPixels : kFanPixels); ++k) {
      // (3, 0), (5, 0), (7, 0) ... or (1, 0), (2, -1), (2, 1), (3, -2), (3, 2) ...: all are of the other color.
      const int along = is_strip ? 3 + 2 * k : 1 + (k + 1) / 2;
      const int across = is_strip ? 0 : k % 2 == 1 ? 1 - along : along - 1;
      const int x = x_ + along * right - across * down, y = y_ + along * down + across * right;
      if (x < 0 || y < 0 || x >= view_.width || y >= view_.height) continue;
      const int64_t i = view_.Index(x, y);
      const float cost = view_.costs[i];
      if (!(cost < best) || !(view_.planes[i].inv_depth > 0)) continue;
      best = cost;
      best_x = x, best_y = y;
    }
    if (!(best < std::numeric_limits<float>::infinity())) return false;
    const Plane p = view_.planes[view_.Index(best_x, best_y)];
    *plane = {p.At(static_cast<float>(x_ - best_x), static_cast<float>(y_ - best_y)), p.dx, p.dy};
    return true;
  }

  /// Distance between start and end of a round trip over a source's depth.
  ORACLEGS_HD inline float GeometricCost(const SearchSource& source, float inv_depth) const {
    if (source.known.planes == nullptr) return 0;
    const RoundTrip trip = GoAndReturn(source.there, source.back, source.known, {u_, v_, inv_depth});
    return kGeometricWeight * (trip.seen && trip.pixels < kGeometricLimit ? trip.pixels : kGeometricLimit);
  }

  /// Sets the sources' weights at this pixel: the point is probably occluded in a source in which most hypotheses fail.
  ORACLEGS_HD inline void WeighSources(int iteration, int hypotheses) {
    const int n = view_.num_sources, min_good = kMinGood < hypotheses ? kMinGood : hypotheses;
    const float good_cost = kGoodCost * std::exp(-static_cast<float>(iteration * iteration) / 90);
    float total = 0;
    for (int s = 0; s < n; ++s) {
      int good = 0, bad = 0;
      float likelihoods = 0;
      for (int h = 0; h < hypotheses; ++h) {
        const float cost = costs_[h * n + s];
        bad += cost > kBadCost ? 1 : 0;
        if (!(cost < good_cost)) continue;
        ++good;
        likelihoods += Likelihood(cost);
      }
      weights_[s] = good >= min_good && bad < kMaxBad ? likelihoods / static_cast<float>(good) : 0;
      total += weights_[s];
    }
    if (total > 0) return;
    // No source is good: all are weighed by likelihood. A random plane may be the first that falls into an image.
    for (int s = 0; s < n; ++s) {
      float best = kWorstCost;
      for (int h = 0; h < hypotheses; ++h) best = costs_[h * n + s] < best ? costs_[h * n + s] : best;
      weights_[s] = Likelihood(best) + 1e-6f;
    }
  }
  ORACLEGS_HD inline static float Likelihood(float cost) {
    return std::exp(-cost * cost / (2 * kCostSigma * kCostSigma));
  }

  /// Keeps the plane if it is the best so far; costs[s]: its photometric costs.
  ORACLEGS_HD inline void Consider(const Plane& plane, const float* costs) {
    float photometric = 0, total = 0;
    for (int s = 0; s < view_.num_sources; ++s) {
      photometric += weights_[s] * costs[s];
      total += weights_[s];
    }
    // Rejects most planes before their geometric term, which takes two projections a source.
    if (!(total > 0) || !(photometric / total < best_score_)) return;
    float score = photometric;
    for (int s = 0; s < view_.num_sources; ++s) {
      if (weights_[s] > 0) score += weights_[s] * GeometricCost(view_.sources[s], plane.inv_depth);
    }
    if (!(score / total < best_score_)) return;
    best_ = plane;
    best_score_ = score / total;
    best_cost_ = photometric / total;
  }

  /// A plane's inverse depth, randomly changed by 3 % to 0.2 %.
  ORACLEGS_HD inline static float NearDepth(const Plane& start, PixelRandom* random) {
    const float step = std::exp2(-5 - 4 * random->Unit());
    return start.inv_depth * (1 + step * random->Signed());
  }
  /// Tilts the plane randomly, near the start's tilt.
  ORACLEGS_HD inline void TurnFrom(const Plane& start, PixelRandom* random, Plane* plane) const {
    const float step = std::exp2(-1 - 3 * random->Unit());
    plane->dx = start.dx + plane->inv_depth * step * random->Signed() / view_.fx;
    plane->dy = start.dy + plane->inv_depth * step * random->Signed() / view_.fy;
  }

  /// Random plane number `which`; call in order, since their numbers are drawn one after another.
  ORACLEGS_HD inline Plane Refinement(int which, const Plane& start, PixelRandom* random) const {
    Plane plane = start;
    if (which == 0) {  // elsewhere, as tilted as now
      plane.inv_depth = RandomInverseDepth(view_, random);
      const float ratio = plane.inv_depth / start.inv_depth;
      plane.dx *= ratio, plane.dy *= ratio;
    } else if (which <= 2) {  // anything; then here, tilted anew
      if (which == 1) plane.inv_depth = RandomInverseDepth(view_, random);
      Tilt(view_, random, &plane);
    } else {  // a little nearer or farther; a little turned; both
      if (which != 4) plane.inv_depth = NearDepth(start, random);
      if (which != 3) TurnFrom(start, random, &plane);
    }
    return plane;
  }

  ORACLEGS_HD inline void Refine(int iteration, int64_t pixel) {
    PixelRandom random(view_, iteration, pixel);
    Plane start = best_;
    if (!(start.inv_depth > 0)) start = {RandomInverseDepth(view_, &random), 0, 0};
    Plane planes[kRefinements];
    int count = 0;
    for (int which = view_.local ? kFirstLocal : 0; which < kRefinements; ++which) {
      const Plane plane = Refinement(which, start, &random);
      if (IsAllowed(plane)) planes[count++] = plane;
    }
    if (count == 0) return;
    costs_of_(planes, count, active_, costs_);
    for (int h = 0; h < count; ++h) Consider(planes[h], costs_ + h * view_.num_sources);
  }

  const SearchView& view_;
  const CostsOf& costs_of_;
  int x_, y_;
  float u_, v_;  ///< the pixel's center
  float costs_[kHypotheses * kMaxSources];
  float weights_[kMaxSources];
  uint8_t active_[kMaxSources];
  Plane best_;
  float best_score_ = std::numeric_limits<float>::infinity();  ///< with the geometric term
  float best_cost_ = kWorstCost;                               ///< without the geometric term
};

}  // namespace oraclegs
