#include "oraclegs/propose/warp.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "oraclegs/propose/fill_depth.h"
#include "oraclegs/propose/push_pull.h"

namespace oraclegs {
namespace {

constexpr float kLeastConfidence = 0.04f;   // of a depth that takes part
constexpr float kWidestSplat = 4;           // pixels to either side
constexpr float kSameSurface = 0.02f;       // relative difference of inverse depth
constexpr float kSeenThroughDepth = 0.03f;  // from which difference on a photograph looks past a point
constexpr float kAgainst = 0.15f;           // of a vote, for a photograph that looks through the surface
constexpr float kFrontVotes = 0.03f;        // of the best surface's; a front surface is often seen by few photographs
constexpr float kVoteAngle = 25, kColorAngle = 8;  // degrees over which a photograph's say falls by e
constexpr float kVisible = 0.02f;                  // relative depth over which it does
constexpr float kUnknownVisible = 0.05f;           // where the photograph's own depth is not known
constexpr size_t kBlended = 4;                     // photographs a colour is mixed from
constexpr float kWellKnown = 0.02f;                // weight from which on a colour is not mixed with its surroundings'
constexpr int kRaySteps = 64;
constexpr float kDegrees = static_cast<float>(180 / M_PI);

float DegreesBetween(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * kDegrees;
}

/// Bilinear; (u, v) inside the picture.
Eigen::Vector3f ColorAt(const ImageF& image, float u, float v) {
  const float x = std::clamp(u - 0.5f, 0.f, static_cast<float>(image.width - 1));
  const float y = std::clamp(v - 0.5f, 0.f, static_cast<float>(image.height - 1));
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const int x1 = std::min(x0 + 1, image.width - 1), y1 = std::min(y0 + 1, image.height - 1);
  const float a = x - static_cast<float>(x0), b = y - static_cast<float>(y0);
  const auto at = [&](int px, int py) { return Eigen::Map<const Eigen::Vector3f>(image.row(py) + 3 * px); };
  return (1 - b) * ((1 - a) * at(x0, y0) + a * at(x1, y0)) + b * ((1 - a) * at(x0, y1) + a * at(x1, y1));
}

/// What a photograph says of a point of the new view.
struct Sighting {
  bool in_frame = false;
  float u = 0, v = 0;    ///< pixel
  size_t index = 0;      ///< the same, row by row
  float confidence = 0;  ///< of the photograph's depth there, 0 = unknown
  float relative = 0;    ///< inverse depth there over the point's, minus 1: > 0 something stands before it
  float angle = 90;      ///< degrees between the rays
  float resolution = 0;  ///< pixels of the photograph in one of the new view, per axis, at most 1
};

}  // namespace

/// Where the photographs stand, seen from the new view.
struct Warper::Geometry {
  std::vector<size_t> views;            // that take part
  std::vector<PixelMap> there;          // of those, from the new view's pixels
  std::vector<Eigen::Vector3f> center;  // in the new camera's frame

  Sighting See(const WarpSources& sources, size_t k, const Camera& camera, const Eigen::Vector3f& uvw) const {
    Sighting s;
    const DepthMap& map = sources.maps[views[k]];
    const Eigen::Vector3f q = there[k](uvw.x(), uvw.y(), uvw.z());
    if (!(q.z() > 0)) return s;
    s.u = q.x() / q.z(), s.v = q.y() / q.z();
    const auto width = static_cast<float>(map.camera.width), height = static_cast<float>(map.camera.height);
    if (!(s.u >= 0 && s.v >= 0 && s.u < width && s.v < height)) return s;
    s.index = static_cast<size_t>(s.v) * static_cast<size_t>(map.camera.width) + static_cast<size_t>(s.u);
    const std::vector<uint8_t>& mask = sources.photos[views[k]].mask;
    if (!mask.empty() && mask[s.index] == 0) return s;
    s.in_frame = true;
    const float expected = uvw.z() / q.z();
    if (map.inv_depth[s.index] > 0) {
      s.confidence = map.confidence[s.index];
      s.relative = map.inv_depth[s.index] / expected - 1;
    }
    const Eigen::Vector3f point = RayOf(camera, uvw.x(), uvw.y()) / uvw.z();
    s.angle = DegreesBetween(point, point - center[k]);
    s.resolution =
        std::min(1.f, expected * static_cast<float>(map.camera.fx) / (uvw.z() * static_cast<float>(camera.fx)));
    return s;
  }
};

/// Depths that fall on each pixel, pixel by pixel.
struct Warper::Samples {
  struct Sample {
    float inv_depth;
    uint16_t view;
    uint16_t weight;  // confidence, 65535 = 1
  };
  std::vector<size_t> begin;  // of each pixel, and the end
  std::vector<Sample> samples;
};

Warper::Warper(WarpSources sources) : sources_(std::move(sources)) {
  std::vector<float> depths;
  for (const DepthMap& map : sources_.maps) {
    for (size_t i = 0; i < map.size(); i += 7) {
      if (map.confidence[i] >= kConfident) depths.push_back(1 / map.inv_depth[i]);
    }
  }
  if (depths.empty()) return;
  const auto at = [&](double share) {
    const auto nth = depths.begin() + static_cast<int64_t>(share * static_cast<double>(depths.size() - 1));
    std::nth_element(depths.begin(), nth, depths.end());
    return *nth;
  };
  nearest_ = 0.8f * at(0.005), farthest_ = 1.25f * at(0.995);
}

Warper::Samples Warper::Splat(const Camera& camera, int hidden) const {
  Samples result;
  result.begin.assign(static_cast<size_t>(camera.width) * camera.height + 1, 0);
  const auto each = [&](const auto& take) {
    for (size_t v = 0; v < sources_.maps.size(); ++v) {
      if (static_cast<int>(v) == hidden) continue;
      const DepthMap& map = sources_.maps[v];
      const PixelMap to_new = MapBetween(map.camera, camera);
      for (int y = 0; y < map.camera.height; ++y) {
        for (int x = 0; x < map.camera.width; ++x) {
          const size_t i = static_cast<size_t>(y) * map.camera.width + x;
          if (!(map.confidence[i] > kLeastConfidence) || !(map.inv_depth[i] > 0)) continue;
          const Eigen::Vector3f q =
              to_new(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, map.inv_depth[i]);
          if (!(q.z() > 0)) continue;
          const float w = map.inv_depth[i] / q.z(), px = q.x() / q.z(), py = q.y() / q.z();
          const float size = static_cast<float>(camera.fx / map.camera.fx) / q.z();
          const float reach = std::min(kWidestSplat, 0.5f * std::max(1.f, size) + 0.25f);
          if (!(px > -reach && py > -reach && px < static_cast<float>(camera.width) + reach &&
                py < static_cast<float>(camera.height) + reach)) {
            continue;
          }
          const int left = std::max(0, static_cast<int>(std::ceil(px - reach - 0.5f)));
          const int right = std::min(camera.width - 1, static_cast<int>(std::floor(px + reach - 0.5f)));
          const int top = std::max(0, static_cast<int>(std::ceil(py - reach - 0.5f)));
          const int bottom = std::min(camera.height - 1, static_cast<int>(std::floor(py + reach - 0.5f)));
          const Samples::Sample sample{w, static_cast<uint16_t>(v),
                                       static_cast<uint16_t>(65535 * std::min(1.f, map.confidence[i]))};
          for (int ty = top; ty <= bottom; ++ty) {
            for (int tx = left; tx <= right; ++tx) take(static_cast<size_t>(ty) * camera.width + tx, sample);
          }
        }
      }
    }
  };
  each([&](size_t pixel, const Samples::Sample&) { ++result.begin[pixel + 1]; });
  for (size_t i = 1; i < result.begin.size(); ++i) result.begin[i] += result.begin[i - 1];
  result.samples.resize(result.begin.back());
  std::vector<size_t> next(result.begin.begin(), result.begin.end() - 1);
  each([&](size_t pixel, const Samples::Sample& sample) { result.samples[next[pixel]++] = sample; });
  return result;
}

/// Inverse depth of the nearest surface that has enough votes; 0 where no depth falls.
float Warper::Surface(const Camera& camera, const Geometry& geometry, size_t pixel, const Samples& samples) const {
  struct Cluster {
    float inv_depth = 0, vote = 0;
  };
  std::vector<Samples::Sample> here(samples.samples.begin() + static_cast<int64_t>(samples.begin[pixel]),
                                    samples.samples.begin() + static_cast<int64_t>(samples.begin[pixel + 1]));
  if (here.empty()) return 0;
  std::sort(here.begin(), here.end(), [](const auto& a, const auto& b) {
    return a.inv_depth != b.inv_depth ? a.inv_depth > b.inv_depth : a.view < b.view;
  });
  const auto width = static_cast<size_t>(camera.width);
  const float u = static_cast<float>(pixel % width) + 0.5f, v = static_cast<float>(pixel / width) + 0.5f;
  std::vector<Cluster> clusters;
  std::vector<float> votes(geometry.views.size());
  float best = 0;
  for (size_t first = 0; first < here.size();) {
    size_t last = first;
    float sum = 0, total = 0;
    for (; last < here.size() && here[last].inv_depth > here[first].inv_depth * (1 - kSameSurface); ++last) {
      sum += here[last].weight * here[last].inv_depth, total += here[last].weight;
    }
    Cluster cluster{sum / total, 0};
    std::fill(votes.begin(), votes.end(), 0.f);
    for (size_t s = first; s < last; ++s) {
      const auto k = static_cast<size_t>(std::lower_bound(geometry.views.begin(), geometry.views.end(), here[s].view) -
                                         geometry.views.begin());
      votes[k] = std::max(votes[k], static_cast<float>(here[s].weight) / 65535);
    }
    for (size_t k = 0; k < geometry.views.size(); ++k) {
      const Sighting s = geometry.See(sources_, k, camera, {u, v, cluster.inv_depth});
      const float say = std::exp(-s.angle / kVoteAngle);
      if (votes[k] > 0) {
        cluster.vote += votes[k] * say;
      } else if (s.in_frame && s.relative < -kSeenThroughDepth) {
        cluster.vote -= kAgainst * s.confidence * say;
      }
    }
    best = std::max(best, cluster.vote);
    clusters.push_back(cluster);
    first = last;
  }
  for (const Cluster& cluster : clusters) {
    if (cluster.vote > 0 && cluster.vote >= kFrontVotes * best) return cluster.inv_depth;
  }
  return 0;
}

/// No point of the ray, as far as surfaces are known, projects onto the object in every photograph. Silhouettes are
/// those of objects that photographs show whole, so beyond a picture's border there is nothing either.
bool Warper::MissesObject(const Geometry& geometry, float u, float v) const {
  for (int step = 0; step < kRaySteps; ++step) {
    const float depth = nearest_ + (farthest_ - nearest_) * static_cast<float>(step) / (kRaySteps - 1);
    bool inside = true;
    for (size_t k = 0; inside && k < geometry.views.size(); ++k) {
      const Camera& camera = sources_.maps[geometry.views[k]].camera;
      const Eigen::Vector3f q = geometry.there[k](u, v, 1 / depth);
      const float x = q.x() / q.z(), y = q.y() / q.z();
      inside = q.z() > 0 && x >= 0 && y >= 0 && x < static_cast<float>(camera.width) &&
               y < static_cast<float>(camera.height) && sources_.silhouettes->MayContain(geometry.views[k], x, y);
    }
    if (inside) return false;
  }
  return true;
}

/// Colours and evidence of the pixels whose depth stands; `known`: how far each colour is, for PushPull.
void Warper::Shade(const Camera& camera, const Geometry& geometry, WarpedView* view, std::vector<float>* known) const {
  struct Shown {
    float weight;
    Eigen::Vector3f color;
    uint16_t photo;
  };
  std::vector<Shown> shown;
  for (size_t i = 0; i < view->inv_depth.size(); ++i) {
    PixelEvidence& e = view->evidence[i];
    if (e.background > 0) {
      std::copy(sources_.background.begin(), sources_.background.end(), &view->rgb.data[3 * i]);
      (*known)[i] = 1;
      continue;
    }
    const auto width = static_cast<size_t>(camera.width);
    const Eigen::Vector3f uvw(static_cast<float>(i % width) + 0.5f, static_cast<float>(i / width) + 0.5f,
                              view->inv_depth[i]);
    if (!(uvw.z() > 0)) continue;
    shown.clear();
    for (size_t k = 0; k < geometry.views.size(); ++k) {
      const Sighting s = geometry.See(sources_, k, camera, uvw);
      if (!s.in_frame) continue;
      const float off = s.relative / kVisible;
      const float visible = s.confidence > 0 ? std::exp(-off * off) : kUnknownVisible;
      if (s.relative < -kSeenThroughDepth) e.conflicts += s.confidence;
      if (s.relative > kSeenThroughDepth) e.hidden += s.confidence;
      e.support += visible * (0.1f + s.confidence) * std::exp(-s.angle / kVoteAngle);
      e.views += visible;
      if (visible > 0.5f) e.angle = std::min(e.angle, s.angle);
      e.confidence = std::max(e.confidence, visible * s.confidence);
      e.resolution = std::max(e.resolution, visible * s.resolution);
      Eigen::Vector3f color = ColorAt(sources_.photos[geometry.views[k]].rgb, s.u, s.v);
      if (!sources_.gains.empty()) color = color.cwiseQuotient(sources_.gains[geometry.views[k]]).cwiseMin(1.f);
      shown.push_back({visible * (0.1f + s.confidence) * std::exp(-s.angle / kColorAngle) * s.resolution, color,
                       static_cast<uint16_t>(geometry.views[k] + 1)});
    }
    const size_t n = std::min(kBlended, shown.size());
    std::partial_sort(
        shown.begin(), shown.begin() + static_cast<int64_t>(n), shown.end(),
        [](const Shown& a, const Shown& b) { return a.weight != b.weight ? a.weight > b.weight : a.photo < b.photo; });
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    float total = 0, squares = 0;
    for (size_t s = 0; s < n; ++s) sum += shown[s].weight * shown[s].color, total += shown[s].weight;
    if (!(total > 1e-12f)) continue;
    const Eigen::Vector3f color = sum / total;
    for (size_t s = 0; s < n; ++s) squares += shown[s].weight * (shown[s].color - color).squaredNorm();
    e.spread = std::sqrt(squares / (3 * total));
    Eigen::Map<Eigen::Vector3f>(&view->rgb.data[3 * i]) = color;
    view->provenance[i] = shown[0].photo;
    // The angle's say is relative: a colour seen from far off is still better than none.
    (*known)[i] = std::min(1.f, std::min(e.support, e.views) / kWellKnown);
  }
}

WarpedView Warper::Warp(const Camera& camera, int hidden) const {
  const size_t pixels = static_cast<size_t>(camera.width) * camera.height;
  Geometry geometry;
  for (size_t v = 0; v < sources_.maps.size(); ++v) {
    if (static_cast<int>(v) == hidden) continue;
    geometry.views.push_back(v);
    geometry.there.push_back(MapBetween(camera, sources_.maps[v].camera));
    geometry.center.push_back((camera.cam_from_world * sources_.maps[v].camera.Center()).cast<float>());
  }
  WarpedView view;
  view.rgb = {camera.width, camera.height, 3, std::vector<float>(3 * pixels)};
  for (size_t i = 0; i < 3 * pixels; ++i) view.rgb.data[i] = sources_.background[i % 3];
  view.inv_depth.assign(pixels, 0);
  view.evidence.resize(pixels);
  view.provenance.assign(pixels, 0);
  const Samples samples = Splat(camera, hidden);
  const bool bounded = sources_.silhouettes != nullptr && !sources_.silhouettes->empty() && nearest_ > 0;
  const auto width = static_cast<size_t>(camera.width);
  std::vector<uint8_t> to_fill(pixels, 0);
  for (size_t i = 0; i < pixels; ++i) {
    view.inv_depth[i] = Surface(camera, geometry, i, samples);
    if (view.inv_depth[i] > 0) continue;
    if (bounded && MissesObject(geometry, static_cast<float>(i % width) + 0.5f, static_cast<float>(i / width) + 0.5f)) {
      view.evidence[i].background = 1;
    } else {
      to_fill[i] = 1;
    }
  }
  const std::vector<float> rings = FillDepth(camera.width, camera.height, to_fill, &view.inv_depth);
  for (size_t i = 0; i < pixels; ++i) view.evidence[i].ring = rings[i];
  std::vector<float> known(pixels, 0);
  Shade(camera, geometry, &view, &known);
  PushPull(known, &view.rgb);
  return view;
}

std::optional<Proposal> WarpProposer::Propose(const Target& target, int hidden) const {
  WarpedView view = warper_.Warp(target.camera, hidden);
  Proposal proposal{target.name, name(), target.camera, std::move(view.rgb)};
  proposal.inv_depth = std::move(view.inv_depth);
  proposal.provenance = std::move(view.provenance);
  return proposal;
}

}  // namespace oraclegs
