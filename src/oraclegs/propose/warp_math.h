#pragma once
// The mathematics of one depth and of one pixel of the forward warp, for host and device
// (docs/method.md#warp-proposals). Devices choose the order of the pixels (warp_device.h).

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "oraclegs/core/device_macros.h"
#include "oraclegs/depth/plane_math.h"

namespace oraclegs {

inline constexpr float kMinWarpConfidence = 0.04f;  // of a depth that is splatted
inline constexpr float kMaxSplat = 4;               // pixels to either side
inline constexpr float kSameSurface = 0.02f;        // relative difference of inverse depth
inline constexpr float kSeenThroughDepth = 0.03f;   // of relative difference, from which a view sees through a point
inline constexpr float kAgainst = 0.15f;     // share of a vote that a view which sees through the surface subtracts
inline constexpr float kFrontVotes = 0.03f;  // of the best surface's; a front surface is often seen by few views
inline constexpr float kVoteAngle = 25, kColorAngle = 8;  // degrees over which a view's weight falls by e
inline constexpr float kVisible = 0.02f;                  // relative depth over which it falls
inline constexpr float kUnknownVisible = 0.05f;           // where the view's own depth is unknown
inline constexpr int kBlended = 4;                        // views a color is mixed from
inline constexpr float kWellKnown = 0.02f;  // weight from which on a color is not mixed with its surroundings'
inline constexpr int kRaySteps = 64;
inline constexpr float kDegrees = static_cast<float>(180 / M_PI);
inline constexpr float kFullWeight = 65535;

ORACLEGS_HD inline Vec3f Cross(const Vec3f& a, const Vec3f& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

ORACLEGS_HD inline float DegreesBetween(const Vec3f& a, const Vec3f& b) {
  const Vec3f cross = Cross(a, b);
  return std::atan2(std::sqrt(Dot(cross, cross)), Dot(a, b)) * kDegrees;
}

/// Evidence for a warped pixel.
struct PixelEvidence {
  float support = 0;     ///< sum over the views that show the point of (0.1 + confidence); nearer views weigh more
  float views = 0;       ///< number of views that show it
  float angle = 90;      ///< degrees between the ray and that of the nearest view that shows the point; 90 = none
  float spread = 0;      ///< RMS difference of the views' colors
  float confidence = 0;  ///< confidence of the depth, in the most confident view
  float conflicts = 0;   ///< summed confidence of views that look through the point
  float occluded = 0;    ///< summed confidence of views in which something stands before it
  float ring = 0;        ///< pixels to the nearest one whose depth was warped, 0 for those
  float resolution = 0;  ///< pixels of the best view in one pixel, per axis, at most 1
  float background = 0;  ///< 1 = the ray misses the object
};

/// A source view and its pose relative to the new view. Images row by row, in the device's memory.
struct WarpSource {
  const float* rgb = nullptr;            ///< [H,W,3]
  const float* inv_depth = nullptr;      ///< [H,W]
  const float* confidence = nullptr;     ///< [H,W]
  const uint8_t* mask = nullptr;         ///< [H,W], 1 = used; null: all are
  const uint8_t* near_object = nullptr;  ///< [H,W], SilhouetteMask::grown; null: there are no silhouettes
  int width = 0, height = 0;
  int number = 0;           ///< number of the view
  float focal = 0;          ///< pixels
  float magnification = 0;  ///< focal length of the new view over this view's
  bool exposed = false;     ///< whether colors are divided by the gain
  float gain[3] = {1, 1, 1};
  PlainPixelMap to_new, from_new;
  Vec3f center;  ///< in the new camera's frame
};

/// The new view and the sources that it is warped from.
struct WarpScene {
  const WarpSource* sources = nullptr;  ///< in the device's memory
  int count = 0;
  int width = 0, height = 0;
  float fx = 0, fy = 0, cx = 0, cy = 0;
  float background[3] = {0, 0, 0};
  bool bounded = false;             ///< whether nothing is outside the silhouettes
  float nearest = 0, farthest = 0;  ///< distances of the known surfaces

  ORACLEGS_HD inline size_t pixels() const { return static_cast<size_t>(width) * static_cast<size_t>(height); }
  ORACLEGS_HD inline float CenterX(size_t pixel) const {
    return static_cast<float>(pixel % static_cast<size_t>(width)) + 0.5f;
  }
  ORACLEGS_HD inline float CenterY(size_t pixel) const {
    return static_cast<float>(pixel / static_cast<size_t>(width)) + 0.5f;
  }
};

/// Pixels of the new view that a source's depth falls on: corners included, empty when right < left.
struct DepthSplat {
  float inv_depth = 0;
  int left = 0, top = 0, right = -1, bottom = -1;
};

ORACLEGS_HD inline DepthSplat SplatOf(const WarpScene& scene, const WarpSource& from, int x, int y) {
  DepthSplat splat;
  const size_t i = static_cast<size_t>(y) * static_cast<size_t>(from.width) + static_cast<size_t>(x);
  const float inv_depth = from.inv_depth[i];
  if (!(from.confidence[i] > kMinWarpConfidence) || !(inv_depth > 0)) return splat;
  const Vec3f q = from.to_new(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, inv_depth);
  if (!(q.z > 0)) return splat;
  const float px = q.x / q.z, py = q.y / q.z, size = from.magnification / q.z;
  // Copied to a local, since device code has no address of a host's constant.
  const float reach = std::min(float{kMaxSplat}, 0.5f * std::max(1.f, size) + 0.25f);
  if (!(px > -reach && py > -reach && px < static_cast<float>(scene.width) + reach &&
        py < static_cast<float>(scene.height) + reach)) {
    return splat;
  }
  splat.inv_depth = inv_depth / q.z;
  splat.left = std::max(0, static_cast<int>(std::ceil(px - reach - 0.5f)));
  splat.right = std::min(scene.width - 1, static_cast<int>(std::floor(px + reach - 0.5f)));
  splat.top = std::max(0, static_cast<int>(std::ceil(py - reach - 0.5f)));
  splat.bottom = std::min(scene.height - 1, static_cast<int>(std::floor(py + reach - 0.5f)));
  return splat;
}

/// A depth that falls on a pixel.
struct WarpSample {
  float inv_depth;
  uint16_t source;  ///< index in WarpScene::sources
  uint16_t weight;  ///< confidence, kFullWeight = 1
};

ORACLEGS_HD inline WarpSample SampleOf(float inv_depth, int source, float confidence) {
  return {inv_depth, static_cast<uint16_t>(source), static_cast<uint16_t>(kFullWeight * std::min(1.f, confidence))};
}

/// A source view's observation of a point of the new view.
struct Sighting {
  bool in_frame = false;
  float u = 0, v = 0;    ///< pixel
  float confidence = 0;  ///< confidence of the source's depth there, 0 = unknown
  float relative = 0;    ///< inverse depth there over the point's, minus 1; > 0 = occluded
  float resolution = 0;  ///< pixels of the source in one of the new view, per axis, at most 1
};

ORACLEGS_HD inline Sighting See(const WarpScene& scene, const WarpSource& from, float u, float v, float inv_depth) {
  Sighting s;
  const Vec3f q = from.from_new(u, v, inv_depth);
  if (!(q.z > 0)) return s;
  s.u = q.x / q.z, s.v = q.y / q.z;
  if (!(s.u >= 0 && s.v >= 0 && s.u < static_cast<float>(from.width) && s.v < static_cast<float>(from.height))) {
    return s;
  }
  const size_t i = static_cast<size_t>(s.v) * static_cast<size_t>(from.width) + static_cast<size_t>(s.u);
  if (from.mask != nullptr && from.mask[i] == 0) return s;
  s.in_frame = true;
  const float expected = inv_depth / q.z, known = from.inv_depth[i];
  if (known > 0) {
    s.confidence = from.confidence[i];
    s.relative = known / expected - 1;
  }
  s.resolution = std::min(1.f, expected * from.focal / (inv_depth * scene.fx));
  return s;
}

/// Degrees between the rays of the new view and of a source to a point.
ORACLEGS_HD inline float AngleAt(const WarpScene& scene, const WarpSource& from, float u, float v, float inv_depth) {
  const Vec3f point{(u - scene.cx) / scene.fx / inv_depth, (v - scene.cy) / scene.fy / inv_depth, 1 / inv_depth};
  return DegreesBetween(point, {point.x - from.center.x, point.y - from.center.y, point.z - from.center.z});
}

/// A candidate surface of a pixel; stored in place of samples already read.
struct WarpSurface {
  float inv_depth, vote;
};
static_assert(sizeof(WarpSurface) == sizeof(WarpSample));

/// A point on a pixel's ray.
struct RayPoint {
  float u, v;  ///< the pixel's center
  float inv_depth;
};

/// A view's vote for a surface whose samples have been counted, before the angle's weight: its largest weight among
/// them, or what it subtracts as it sees through the surface.
template <class Votes>
ORACLEGS_HD inline float VoteOf(const WarpScene& scene, int source, const RayPoint& at, const Votes& votes) {
  if (const float vote = votes.Of(source); vote > 0) return vote;
  const Sighting s = See(scene, scene.sources[source], at.u, at.v, at.inv_depth);
  return s.in_frame && s.relative < -kSeenThroughDepth ? -kAgainst * s.confidence : 0;
}

/// Whether views vote for a surface whose samples have been counted, and none against it.
template <class Votes>
ORACLEGS_HD inline bool IsUndisputed(const WarpScene& scene, const RayPoint& at, const Votes& votes) {
  bool has_votes = false;
  for (int k = 0; k < scene.count; ++k) {
    const float vote = VoteOf(scene, k, at, votes);
    if (vote < 0) return false;
    has_votes = has_votes || vote > 0;
  }
  return has_votes;
}

/// Inverse depth of the nearest surface that has enough votes, 0 without samples. The samples must be sorted near to
/// far, ties by source, and are overwritten. votes.Count(begin, end) takes the samples of a surface, and
/// votes.Of(source) returns the largest weight of a source among them, in [0, 1], 0 without one.
template <class Votes>
ORACLEGS_HD inline float SurfaceAmong(const WarpScene& scene, size_t pixel, WarpSample* samples, size_t count,
                                      Votes&& votes) {
  const float u = scene.CenterX(pixel), v = scene.CenterY(pixel);
  size_t surfaces = 0;
  float best = 0;
  for (size_t first = 0; first < count;) {
    const float end_of_surface = samples[first].inv_depth * (1 - kSameSurface);
    size_t last = first;
    float sum = 0, total = 0;
    do {
      const float weight = samples[last].weight;
      sum += weight * samples[last].inv_depth, total += weight;
      ++last;
    } while (last < count && samples[last].inv_depth > end_of_surface);
    WarpSurface surface{sum / total, 0};
    votes.Count(samples + first, samples + last);
    const bool is_only = first == 0 && last == count;
    const RayPoint at{u, v, surface.inv_depth};
    if (is_only && IsUndisputed(scene, at, votes)) return surface.inv_depth;
    for (int k = 0; k < scene.count; ++k) {
      const float vote = VoteOf(scene, k, at, votes);
      if (vote == 0) continue;
      surface.vote += vote * std::exp(-AngleAt(scene, scene.sources[k], u, v, surface.inv_depth) / kVoteAngle);
    }
    best = std::max(best, surface.vote);
    samples[surfaces++] = std::bit_cast<WarpSample>(surface);
    first = last;
  }
  for (size_t i = 0; i < surfaces; ++i) {
    const auto surface = std::bit_cast<WarpSurface>(samples[i]);
    if (surface.vote > 0 && surface.vote >= kFrontVotes * best) return surface.inv_depth;
  }
  return 0;
}

/// Whether no point of the pixel's ray, within the range of known surfaces, projects onto the object in every view.
/// Silhouettes are those of objects that the images show whole, so nothing is beyond an image's border.
ORACLEGS_HD inline bool MissesObject(const WarpScene& scene, size_t pixel) {
  const float u = scene.CenterX(pixel), v = scene.CenterY(pixel);
  for (int step = 0; step < kRaySteps; ++step) {
    const float depth = scene.nearest + (scene.farthest - scene.nearest) * static_cast<float>(step) / (kRaySteps - 1);
    bool inside = true;
    for (int k = 0; inside && k < scene.count; ++k) {
      const WarpSource& from = scene.sources[k];
      const Vec3f q = from.from_new(u, v, 1 / depth);
      const float x = q.x / q.z, y = q.y / q.z;
      inside = q.z > 0 && x >= 0 && y >= 0 && x < static_cast<float>(from.width) &&
               y < static_cast<float>(from.height) &&
               from.near_object[static_cast<size_t>(y) * static_cast<size_t>(from.width) + static_cast<size_t>(x)] != 0;
    }
    if (inside) return false;
  }
  return true;
}

}  // namespace oraclegs
