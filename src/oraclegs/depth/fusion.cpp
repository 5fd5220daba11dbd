#include "oraclegs/depth/fusion.h"

#include <algorithm>
#include <cmath>

#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/core/rng.h"
#include "oraclegs/depth/nearest_sources.h"

namespace oraclegs {
namespace {

constexpr size_t kMaxFused = 10;      // views that a point is joined from, beside the one that made it
constexpr float kMuchFiner = 0.7f;    // a pixel that covers less than this share of a point makes a point of its own
constexpr float kSameSide = 0.2f;     // cosine between normals
constexpr float kDetailRange = 0.1f;  // change of luma over two pixels that counts as full detail
constexpr float kFlatShare = 0.1f;    // of the draws where nothing changes
constexpr float kOfFewViews = 0.2f;   // confidence
constexpr double kSureShare = 0.1;    // of the pixels

/// Change of luma over two pixels, relative to kDetailRange, at most 1.
std::vector<float> DetailOf(const ImageF& rgb) {
  const int width = rgb.width, height = rgb.height;
  const auto luma = [&](int x, int y) {
    const float* p = rgb.row(std::clamp(y, 0, height - 1)) + 3 * std::clamp(x, 0, width - 1);
    return 0.299f * p[0] + 0.587f * p[1] + 0.114f * p[2];
  };
  std::vector<float> detail(static_cast<size_t>(width) * height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float dx = luma(x + 1, y) - luma(x - 1, y), dy = luma(x, y + 1) - luma(x, y - 1);
      detail[static_cast<size_t>(y) * width + x] = std::min(1.f, std::sqrt(dx * dx + dy * dy) / kDetailRange);
    }
  }
  return detail;
}

class Fusion {
 public:
  Fusion(const std::vector<DepthMap>& maps, const std::vector<LoadedView>& views, const FusionOptions& options)
      : maps_(maps), views_(views), options_(options), nearest_(maps) {
    for (const DepthMap& map : maps) {
      claimed_.emplace_back(map.size(), 0);
      world_from_cam_.push_back(map.camera.cam_from_world.inverse().cast<float>());
    }
    detail_.resize(views.size());
    ParallelFor(static_cast<int64_t>(views.size()), [&](int64_t task) {
      const auto v = static_cast<size_t>(task);
      if (maps[v].size() > 0) detail_[v] = DetailOf(views[v].rgb);
    });
  }

  std::vector<DensePoint> Run() {
    return PointsOfViews(maps_.size(), [&](size_t v, std::vector<DensePoint>* points) { AddPointsOf(v, points); });
  }

 private:
  struct Pixel {
    size_t view, index;
  };
  /// Another view, and the maps of pixels there and back.
  struct Other {
    size_t view;
    PixelMap there, back;
  };
  /// Points and the pixels that they claim.
  struct Made {
    std::vector<DensePoint> points;
    std::vector<Pixel> pixels;
  };

  Eigen::Vector3f PointAt(size_t view, size_t index) const {
    const Eigen::Vector3f uvw = PixelOf(maps_[view], index);
    return world_from_cam_[view] * (RayOf(maps_[view].camera, uvw.x(), uvw.y()) / uvw.z()).eval();
  }

  float PixelSize(size_t view, size_t index) const {
    return 1 / (maps_[view].inv_depth[index] * static_cast<float>(maps_[view].camera.fx));
  }

  Eigen::Vector3f ColorAt(Pixel p) const {
    const float* c = views_[p.view].rgb.data.data() + 3 * p.index;
    const Eigen::Vector3f rgb(c[0], c[1], c[2]);
    return options_.gains.empty() ? rgb : rgb.cwiseQuotient(options_.gains[p.view]).cwiseMin(1.f).eval();
  }

  void AddPoint(Pixel first, const std::vector<Other>& others, Made* made) const {
    const DepthMap& map = maps_[first.view];
    const Eigen::Vector3f uvw = PixelOf(map, first.index);
    const SamePoint same{options_.max_depth_difference};
    DensePoint point;
    point.pixel_size = PixelSize(first.view, first.index);
    point.views = 0;
    Eigen::Vector3f xyz = Eigen::Vector3f::Zero(), normal = xyz, rgb = xyz;
    float total = 0;
    const Eigen::Vector3f facing = world_from_cam_[first.view].linear() * map.normals[first.index];
    const auto add = [&](Pixel p) {
      const Eigen::Vector3f n = world_from_cam_[p.view].linear() * maps_[p.view].normals[p.index];
      if (n.dot(facing) < kSameSide) return;
      const float size = PixelSize(p.view, p.index);
      const float weight = maps_[p.view].confidence[p.index] / (size * size);  // the nearer view sees it better
      xyz += weight * PointAt(p.view, p.index);
      normal += weight * n;
      rgb += weight * ColorAt(p);
      total += weight;
      point.confidence = std::max(point.confidence, maps_[p.view].confidence[p.index]);
      point.detail = std::max(point.detail, detail_[p.view][p.index]);
      if (size >= kMuchFiner * point.pixel_size) made->pixels.push_back(p);
      ++point.views;
    };
    add(first);
    for (const Other& other : others) {
      if (const auto index = FindPixel(maps_[other.view], other.there, other.back, uvw, same))
        add({other.view, *index});
    }
    point.xyz = xyz / total;
    point.normal = normal.normalized();
    point.rgb = rgb / total;
    made->points.push_back(point);
  }

  /// Adds the points of a view. Rows are processed in parallel and claim their pixels in order: a pixel that two points
  /// use is in both means, but makes no third point.
  void AddPointsOf(size_t view, std::vector<DensePoint>* points) {
    const DepthMap& map = maps_[view];
    if (map.size() == 0) return;
    std::vector<Other> others;
    for (const size_t v : nearest_.For(map.camera, kMaxFused, view)) {
      const Camera& other = maps_[v].camera;
      others.push_back({v, MapBetween(map.camera, other), MapBetween(other, map.camera)});
    }
    const auto width = static_cast<size_t>(map.camera.width);
    std::vector<Made> rows(static_cast<size_t>(map.camera.height));
    ParallelFor(map.camera.height, [&](int64_t y) {
      for (size_t x = 0; x < width; ++x) {
        const size_t i = static_cast<size_t>(y) * width + x;
        if (map.confidence[i] < options_.min_confidence || claimed_[view][i] != 0) continue;
        AddPoint({view, i}, others, &rows[static_cast<size_t>(y)]);
      }
    });
    for (const Made& row : rows) {
      points->insert(points->end(), row.points.begin(), row.points.end());
      for (const Pixel& p : row.pixels) claimed_[p.view][p.index] = 1;
    }
  }

  const std::vector<DepthMap>& maps_;
  const std::vector<LoadedView>& views_;
  const FusionOptions& options_;
  NearestSources nearest_;
  std::vector<std::vector<uint8_t>> claimed_;
  std::vector<std::vector<float>> detail_;
  std::vector<Eigen::Isometry3f> world_from_cam_;
};

}  // namespace

float ConfidenceOfPoints(const std::vector<DepthMap>& maps) {
  constexpr float kFew = 6, kMany = 8;
  double sure = 0, searched = 0;
  for (const DepthMap& map : maps) {
    if (map.monocular) return kConfident;
    sure += ConfidentShare(map), searched += map.size() > 0 ? 1 : 0;
  }
  if (!(sure > kSureShare * searched)) return kConfident;
  const float share = std::clamp((static_cast<float>(maps.size()) - kFew) / (kMany - kFew), 0.f, 1.f);
  return kOfFewViews + share * (kConfident - kOfFewViews);
}

std::vector<DensePoint> FuseDepth(const std::vector<DepthMap>& maps, const std::vector<LoadedView>& views,
                                  const FusionOptions& options) {
  return Fusion(maps, views, options).Run();
}

std::vector<DensePoint> PointsOfViews(size_t views, FunctionRef<void(size_t, std::vector<DensePoint>*)> add) {
  std::vector<DensePoint> points;
  for (size_t v = 0; v < views; ++v) {
    ThrowIfInterrupted();
    add(v, &points);
  }
  return points;
}

std::vector<DensePoint> Thinned(const std::vector<DensePoint>& points, size_t budget, uint64_t seed) {
  if (points.size() <= budget) return points;
  // [Efraimidis 2006]: the largest u^(1/w) are a weighted draw without replacement.
  std::vector<std::pair<float, size_t>> keys(points.size());
  for (size_t i = 0; i < points.size(); ++i) {
    const Philox words = Philox::Draw(seed, static_cast<uint64_t>(RandomStream::kThinning), i);
    keys[i] = {std::log(OpenUniform(words.x[0])) / (kFlatShare + points[i].detail), i};
  }
  std::nth_element(keys.begin(), keys.begin() + static_cast<int64_t>(budget), keys.end(),
                   [](const auto& a, const auto& b) { return a > b; });
  std::vector<size_t> kept(budget);
  for (size_t k = 0; k < budget; ++k) kept[k] = keys[k].second;
  std::sort(kept.begin(), kept.end());
  std::vector<DensePoint> out;
  for (const size_t i : kept) out.push_back(points[i]);
  return out;
}

}  // namespace oraclegs
