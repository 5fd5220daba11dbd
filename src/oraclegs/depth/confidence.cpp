#include "oraclegs/depth/confidence.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "oraclegs/core/parallel.h"
#include "oraclegs/core/statistics.h"
#include "oraclegs/depth/nearest_sources.h"
#include "oraclegs/depth/patch_match.h"

namespace oraclegs {
namespace {

constexpr size_t kMaxWitnesses = 10;                          // views that say whether a depth is right
constexpr float kMaxAngle = 75;                               // degrees between views that can agree
constexpr float kMeasuringAngle = 4, kMinAngleWeight = 0.25;  // degrees below which agreement has less weight
constexpr float kPixelSigma = 0.8f, kDepthSigma = 0.01f;      // of a round trip
constexpr float kSupportRate = 1.1f;
constexpr float kNoAgreement = 1e-4f;                      // changes nothing
constexpr float kUnrelatedCost = 1.15f, kCostSpan = 0.5f;  // a cost of 1 is no similarity at all
constexpr float kSeenThrough = -0.05f;                     // relative depth below which a view looks through the point
constexpr float kSeenThroughCost = 0.5f;                   // of the view that does so, at most
constexpr float kViolationRate = 0.25f;
constexpr int kMedianRadius = 2;
constexpr float kOutlier = 0.05f;      // relative distance from the median
constexpr float kSameSurface = 0.03f;  // relative difference of neighboring pixels
constexpr float kMinConnectedConfidence = 0.3f;
constexpr size_t kMinIslandPixels = 40;
constexpr float kDamping = 0.3f;

struct OtherView {
  PlainPixelMap there, back;
  const PlaneMap* map;
  Eigen::Vector3f center;  ///< in the frame of the view whose confidence is computed
};

/// The other views nearest to this one. Views that look another way are left out later, by the angle between the rays
/// to each point.
std::vector<OtherView> Others(const StereoScene& scene, size_t view, const std::vector<PlaneMap>& maps) {
  NearestSources nearest;
  for (size_t v = 0; v < scene.views.size(); ++v) {
    nearest.Add(scene.views[v].camera, [&planes = maps[v].planes](size_t i) { return planes[i].inv_depth; });
  }
  std::vector<OtherView> others;
  const Camera& camera = scene.views[view].camera;
  for (const size_t v : nearest.For(camera, kMaxWitnesses, view)) {
    const Camera& other = scene.views[v].camera;
    others.push_back({Plain(MapBetween(camera, other)), Plain(MapBetween(other, camera)), &maps[v],
                      (camera.cam_from_world * other.Center()).cast<float>()});
  }
  return others;
}

float AngleBetween(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * static_cast<float>(180 / M_PI);
}

/// Agreement of another view with a point after its round trip: 1 = in full, and from an angle (degrees) that measures.
float Agreement(const RoundTrip& trip, float angle) {
  const float e = trip.pixels / kPixelSigma, r = trip.relative_depth / kDepthSigma;
  return std::clamp(angle / kMeasuringAngle, kMinAngleWeight, 1.f) * std::exp(-(e * e + r * r) / 2);
}

/// Share of [0, 1] that so much agreement makes sure.
float Believed(float support) { return 1 - std::exp(-kSupportRate * support); }

float ConfidenceOf(const Camera& camera, const std::vector<OtherView>& others, const Plane& plane, float cost,
                   const Eigen::Vector2f& uv) {
  const Eigen::Vector3f point = RayOf(camera, uv.x(), uv.y()) / plane.inv_depth;
  float support = 0;
  int violations = 0;
  for (const OtherView& other : others) {
    const RoundTrip trip = GoAndReturn(other.there, other.back, Known(*other.map), {uv.x(), uv.y(), plane.inv_depth});
    if (!trip.seen) continue;
    const float angle = AngleBetween(point, point - other.center);
    if (angle > kMaxAngle) continue;
    support += Agreement(trip, angle);
    if (trip.relative_depth > kSeenThrough) continue;
    const Vec3f q = other.there(uv.x(), uv.y(), plane.inv_depth);
    const int x = static_cast<int>(q.x / q.z), y = static_cast<int>(q.y / q.z);
    violations += other.map->costs[static_cast<size_t>(y) * other.map->width + x] < kSeenThroughCost ? 1 : 0;
  }
  return Believed(support) * std::clamp((kUnrelatedCost - cost) / kCostSpan, 0.f, 1.f) *
         std::exp(-kViolationRate * static_cast<float>(violations));
}

/// The planes of a depth map's pixels.
struct PlanesOfMap {
  const DepthMap& map;
  int width, height;

  Plane At(int x, int y) const {
    const size_t i = static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x);
    const float w = map.inv_depth[i];
    const Eigen::Vector2f slope = RelativeSlope(map, i).value_or(Eigen::Vector2f::Zero());
    return {w, w * slope.x(), w * slope.y()};
  }
};

/// A view that says whether a depth of another is right.
struct Witness {
  PlainPixelMap there, back;
  PlanesOfMap planes;
  Eigen::Vector3f center;  ///< in the frame of the view whose depth it is
};

/// Summed agreement of witnesses with a pixel's point.
float AgreementOf(const std::vector<Witness>& witnesses, const Eigen::Vector3f& uvw, const Eigen::Vector3f& point) {
  float sum = 0;
  for (const Witness& witness : witnesses) {
    const RoundTrip trip = GoAndReturn(witness.there, witness.back, witness.planes, {uvw.x(), uvw.y(), uvw.z()});
    if (!trip.seen) continue;
    const float angle = AngleBetween(point, point - witness.center);
    if (angle <= kMaxAngle) sum += Agreement(trip, angle);
  }
  return sum;
}

/// Witnesses of a view's depth, once with the hidden views and once without them.
struct Witnesses {
  std::vector<Witness> leaving, staying, coming;
};

Witnesses WitnessesOf(const std::vector<DepthMap>& maps, size_t view, const std::vector<int>& hidden) {
  NearestSources rest;
  for (size_t v = 0; v < maps.size(); ++v) {
    if (maps[v].size() == 0 || std::find(hidden.begin(), hidden.end(), static_cast<int>(v)) != hidden.end()) {
      rest.AddNone();
    } else {
      rest.Add(maps[v].camera, [&map = maps[v]](size_t i) { return map.inv_depth[i]; });
    }
  }
  const Camera& camera = maps[view].camera;
  const std::vector<size_t> with = NearestSources(maps).For(camera, kMaxWitnesses, view),
                            without = rest.For(camera, kMaxWitnesses, view);
  Witnesses witnesses;
  for (size_t v = 0; v < maps.size(); ++v) {
    const bool was = std::binary_search(with.begin(), with.end(), v);
    const bool is = std::binary_search(without.begin(), without.end(), v);
    if (!was && !is) continue;
    const Camera& other = maps[v].camera;
    std::vector<Witness>& list = was && is ? witnesses.staying : was ? witnesses.leaving : witnesses.coming;
    list.push_back({Plain(MapBetween(camera, other)),
                    Plain(MapBetween(other, camera)),
                    {maps[v], other.width, other.height},
                    (camera.cam_from_world * other.Center()).cast<float>()});
  }
  return witnesses;
}

/// Damps the confidence of pixels far from the median of their surroundings.
void DampOutliers(const PlaneMap& map, std::vector<float>* confidence) {
  const std::vector<float> before = *confidence;
  ParallelFor(map.height, [&](int64_t row) {
    const int y = static_cast<int>(row);
    std::vector<float> values;
    for (int x = 0; x < map.width; ++x) {
      const size_t i = static_cast<size_t>(y) * map.width + x;
      if (!(before[i] > 0)) continue;
      values.clear();
      for (int v = std::max(0, y - kMedianRadius); v <= std::min(map.height - 1, y + kMedianRadius); ++v) {
        for (int u = std::max(0, x - kMedianRadius); u <= std::min(map.width - 1, x + kMedianRadius); ++u) {
          if (map.At(u, v).inv_depth > 0) values.push_back(map.At(u, v).inv_depth);
        }
      }
      if (std::abs(map.planes[i].inv_depth / UpperMedian(&values) - 1) > kOutlier) (*confidence)[i] *= kDamping;
    }
  });
}

/// Damps the confidence of connected pieces too small to be a surface.
void DampIslands(const PlaneMap& map, std::vector<float>* confidence) {
  const int width = map.width, height = map.height;
  std::vector<uint8_t> visited(confidence->size(), 0);
  std::vector<size_t> piece;
  for (size_t start = 0; start < visited.size(); ++start) {
    if (visited[start] != 0 || (*confidence)[start] < kMinConnectedConfidence) continue;
    piece.assign(1, start);
    visited[start] = 1;
    for (size_t next = 0; next < piece.size(); ++next) {
      const size_t i = piece[next];
      const int x = static_cast<int>(i % static_cast<size_t>(width)),
                y = static_cast<int>(i / static_cast<size_t>(width));
      const auto visit = [&](int u, int v) {
        if (u < 0 || v < 0 || u >= width || v >= height) return;
        const size_t j = static_cast<size_t>(v) * width + u;
        if (visited[j] != 0 || (*confidence)[j] < kMinConnectedConfidence) return;
        if (std::abs(map.planes[j].inv_depth / map.planes[i].inv_depth - 1) > kSameSurface) return;
        visited[j] = 1;
        piece.push_back(j);
      };
      visit(x - 1, y), visit(x + 1, y), visit(x, y - 1), visit(x, y + 1);
    }
    if (piece.size() >= kMinIslandPixels) continue;
    for (const size_t i : piece) (*confidence)[i] *= kDamping;
  }
}

}  // namespace

std::vector<float> Confidence(const StereoScene& scene, size_t view, const std::vector<PlaneMap>& maps) {
  const StereoView& v = scene.views[view];
  const PlaneMap& map = maps[view];
  const std::vector<OtherView> others = Others(scene, view, maps);
  std::vector<float> confidence(map.planes.size(), 0);
  ParallelFor(map.height, [&](int64_t y) {
    for (int x = 0; x < map.width; ++x) {
      const size_t i = static_cast<size_t>(y) * static_cast<size_t>(map.width) + static_cast<size_t>(x);
      if (!(map.planes[i].inv_depth > 0) || (!v.usable.empty() && v.usable[i] == 0)) continue;
      confidence[i] = ConfidenceOf(v.camera, others, map.planes[i], map.costs[i],
                                   {static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
    }
  });
  DampOutliers(map, &confidence);
  DampIslands(map, &confidence);
  return confidence;
}

std::vector<float> ConfidenceWithout(const std::vector<DepthMap>& maps, size_t view, const std::vector<int>& hidden) {
  const DepthMap& map = maps[view];
  std::vector<float> confidence = map.confidence;
  const Witnesses witnesses = WitnessesOf(maps, view, hidden);
  ParallelFor(map.camera.height, [&](int64_t y) {
    for (int x = 0; x < map.camera.width; ++x) {
      const size_t i = static_cast<size_t>(y) * static_cast<size_t>(map.camera.width) + static_cast<size_t>(x);
      if (!(confidence[i] > 0)) continue;
      const Eigen::Vector3f uvw = PixelOf(map, i), point = RayOf(map.camera, uvw.x(), uvw.y()) / uvw.z();
      const float gone = AgreementOf(witnesses.leaving, uvw, point);
      if (gone < kNoAgreement) continue;
      const float stays = AgreementOf(witnesses.staying, uvw, point), comes = AgreementOf(witnesses.coming, uvw, point);
      if (comes < gone) confidence[i] *= Believed(stays + comes) / Believed(stays + gone);
    }
  });
  return confidence;
}

}  // namespace oraclegs
