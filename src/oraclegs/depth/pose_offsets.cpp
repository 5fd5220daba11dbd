#include "oraclegs/depth/pose_offsets.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <map>
#include <optional>

#include "oraclegs/core/parallel.h"
#include "oraclegs/core/statistics.h"
#include "oraclegs/depth/gather_image.h"
#include "oraclegs/depth/reprojection.h"
#include "oraclegs/depth/stereo_setup.h"

namespace oraclegs {
namespace {

constexpr size_t kOffsetSources = 5;   // of each view
constexpr size_t kSharedPoints = 400;  // of each view, that choose the sources
constexpr int kChoiceStep = 2;         // pixels between candidates
constexpr int kOffsetRadius = 4;       // pixels: of a patch, at each resolution
constexpr int kOffsetSide = 2 * kOffsetRadius + 1;
constexpr int kOffsetSamples = kOffsetSide * kOffsetSide;
constexpr int kCoarsestSide = 60;         // pixels: the smaller side of the coarsest resolution, at least
constexpr size_t kOffsetLevels = 3;       // full, half and quarter size
constexpr float kSamePlane = 0.05f;       // relative distance of a depth from its patch's plane
constexpr float kMinSamples = 0.6f;       // share of a patch's pixels that lie on its plane
constexpr float kMinSlope = 3;            // 8-bit units per pixel, RMS in the direction with the least
constexpr float kOcclusion = 0.1f;        // relative depth between a point and what the source view shows
constexpr float kMinCorrelation = 0.85f;  // of the patch that is found
constexpr int kMaxSteps = 12;
constexpr float kFoundStep = 0.02f;                // pixels: a smaller step ends the search
constexpr float kMaxDrift = 3;                     // pixels that a patch may move at one resolution
constexpr float kMinScale = 0.25f, kMaxScale = 4;  // area of a pixel in the source image
constexpr int64_t kPixelsPerTask = 128;
constexpr int kCellsPerSide = 3;        // of an image, for its residual
constexpr size_t kMinCellOffsets = 20;  // fewer say nothing of their cell
constexpr size_t kMinViewCells = 4;     // fewer say nothing of their view

/// Brightness in 8-bit units, smoothed by (1 2 1) / 4 along both axes: a bilinear sample of it is nearly unbiased.
ImageF Smoothed(const ImageF& gray) {
  ImageF out = gray;
  const auto at = [&](int x, int y) {
    return gray.row(std::clamp(y, 0, gray.height - 1))[std::clamp(x, 0, gray.width - 1)];
  };
  ParallelFor(gray.height, [&](int64_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < gray.width; ++x) {
      float sum = 0;
      for (int j = -1; j <= 1; ++j) {
        for (int i = -1; i <= 1; ++i)
          sum += static_cast<float>((2 - std::abs(i)) * (2 - std::abs(j))) * at(x + i, y + j);
      }
      out.row(y)[x] = 255.f / 16 * sum;
    }
  });
  return out;
}

std::vector<ImageF> PyramidOf(const ImageF& rgb) {
  std::vector<ImageF> levels;
  ImageF gray = Luma(rgb);
  while (true) {
    levels.push_back(Smoothed(gray));
    if (levels.size() == kOffsetLevels || std::min(gray.width, gray.height) < 2 * kCoarsestSide) return levels;
    gray = ResizeArea(gray, gray.width / 2, gray.height / 2);
  }
}

/// Bilinear sample at a continuous position; beyond the border the last pixel repeats.
float Bilinear(const ImageF& image, float u, float v) {
  const float x = std::clamp(u - 0.5f, 0.f, static_cast<float>(image.width - 1));
  const float y = std::clamp(v - 0.5f, 0.f, static_cast<float>(image.height - 1));
  const int x0 = std::min(static_cast<int>(x), std::max(0, image.width - 2));
  const int y0 = std::min(static_cast<int>(y), std::max(0, image.height - 2));
  const int right = image.width > 1 ? 1 : 0, down = image.height > 1 ? image.width : 0;
  const float fx = x - static_cast<float>(x0), fy = y - static_cast<float>(y0);
  const float* p = image.row(y0) + x0;
  const float top = p[0] + fx * (p[right] - p[0]), bottom = p[down] + fx * (p[down + right] - p[down]);
  return top + fy * (bottom - top);
}

/// A patch of a reference view at one resolution.
struct Template {
  std::array<float, kOffsetSamples> value{};               ///< 8-bit units
  std::array<float, kOffsetSamples> weight{};              ///< 1 on the patch's plane, else 0
  std::array<Eigen::Vector2f, kOffsetSamples> gradient{};  ///< by the reference view's pixels
  float total = 0;                                         ///< sum of the weights
};

/// `scale` is a pixel of the level in pixels of the map.
Template TemplateAt(const ImageF& image, const DepthMap& map, const OffsetPixel& pixel, const Eigen::Vector2f& scale) {
  constexpr int kSide = kOffsetSide + 2;
  std::array<float, kSide * kSide> values;
  const float u = pixel.u / scale.x(), v = pixel.v / scale.y();
  for (int j = 0; j < kSide; ++j) {
    for (int i = 0; i < kSide; ++i) {
      values[static_cast<size_t>(j * kSide + i)] =
          Bilinear(image, u + static_cast<float>(i - kOffsetRadius - 1), v + static_cast<float>(j - kOffsetRadius - 1));
    }
  }
  Template patch;
  for (int j = 0; j < kOffsetSide; ++j) {
    for (int i = 0; i < kOffsetSide; ++i) {
      const auto k = static_cast<size_t>(j * kOffsetSide + i);
      const float* at = &values[static_cast<size_t>((j + 1) * kSide + i + 1)];
      patch.value[k] = *at;
      patch.gradient[k] = 0.5f * Eigen::Vector2f(at[1] - at[-1], at[kSide] - at[-kSide]);
      const float dx = static_cast<float>(i - kOffsetRadius) * scale.x();
      const float dy = static_cast<float>(j - kOffsetRadius) * scale.y();
      const int x = static_cast<int>(std::floor(pixel.u + dx)), y = static_cast<int>(std::floor(pixel.v + dy));
      if (x < 0 || y < 0 || x >= map.camera.width || y >= map.camera.height) continue;
      const float known = map.inv_depth[static_cast<size_t>(y) * map.camera.width + x];
      const auto expected = static_cast<float>(pixel.inv_depth) * (1 + pixel.slope_x * dx + pixel.slope_y * dy);
      patch.weight[k] = std::abs(known - expected) < kSamePlane * expected ? 1 : 0;
      patch.total += patch.weight[k];
    }
  }
  return patch;
}

/// A patch whose values and gradients are free of what a change of gain and offset of brightness does.
struct NormalizedPatch {
  std::array<float, kOffsetSamples> value;               ///< weighted mean 0
  std::array<Eigen::Vector2f, kOffsetSamples> gradient;  ///< by the source view's pixels
  float square = 0;                                      ///< weighted sum of squares of `value`
  Eigen::Matrix2f tensor = Eigen::Matrix2f::Zero();      ///< weighted sum of the gradients' outer products

  bool HasTexture(float total) const {
    const float mean = 0.5f * tensor.trace();
    const float least = mean - std::sqrt(std::max(0.f, mean * mean - tensor.determinant()));
    return square > 0 && least > kMinSlope * kMinSlope * total;
  }
};

NormalizedPatch Normalized(const Template& patch, const Eigen::Matrix2f& gradient_map) {
  NormalizedPatch out;
  float mean = 0;
  Eigen::Vector2f mean_gradient(0, 0), slope(0, 0);
  for (size_t k = 0; k < kOffsetSamples; ++k) {
    out.gradient[k] = gradient_map * patch.gradient[k];
    mean += patch.weight[k] * patch.value[k];
    mean_gradient += patch.weight[k] * out.gradient[k];
  }
  mean /= patch.total;
  mean_gradient /= patch.total;
  for (size_t k = 0; k < kOffsetSamples; ++k) {
    out.value[k] = patch.value[k] - mean;
    out.gradient[k] -= mean_gradient;
    out.square += patch.weight[k] * out.value[k] * out.value[k];
    slope += patch.weight[k] * out.value[k] * out.gradient[k];
  }
  if (!(out.square > 0)) return out;
  slope /= out.square;
  for (size_t k = 0; k < kOffsetSamples; ++k) {
    out.gradient[k] -= out.value[k] * slope;
    out.tensor += patch.weight[k] * out.gradient[k] * out.gradient[k].transpose();
  }
  return out;
}

/// Positions of a patch's samples in the source image.
struct WarpedPatch {
  std::array<Eigen::Vector2f, kOffsetSamples> at;
  Eigen::Matrix2f by_pixel;  ///< at the center, by the reference view's pixels
};

std::optional<WarpedPatch> Warped(const PixelMap& map, const OffsetPixel& pixel, const Eigen::Vector2f& scale) {
  const auto w = static_cast<float>(pixel.inv_depth);
  const Eigen::Vector3f base = map(pixel.u / scale.x(), pixel.v / scale.y(), w);
  const Eigen::Vector3f right = map.rotation.col(0) + map.translation * (w * pixel.slope_x * scale.x());
  const Eigen::Vector3f down = map.rotation.col(1) + map.translation * (w * pixel.slope_y * scale.y());
  const float reach = kOffsetRadius * (std::abs(right.z()) + std::abs(down.z()));
  if (!(base.z() > 0) || !(reach < 0.5f * base.z())) return std::nullopt;
  WarpedPatch warped;
  const Eigen::Vector2f center = base.head<2>() / base.z();
  warped.by_pixel.col(0) = (right.head<2>() - center * right.z()) / base.z();
  warped.by_pixel.col(1) = (down.head<2>() - center * down.z()) / base.z();
  const float area = warped.by_pixel.determinant();
  if (!(area > kMinScale && area < kMaxScale)) return std::nullopt;
  for (int j = 0; j < kOffsetSide; ++j) {
    for (int i = 0; i < kOffsetSide; ++i) {
      const Eigen::Vector3f q =
          base + right * static_cast<float>(i - kOffsetRadius) + down * static_cast<float>(j - kOffsetRadius);
      warped.at[static_cast<size_t>(j * kOffsetSide + i)] = q.head<2>() / q.z();
    }
  }
  return warped;
}

/// The shift of the warped patch at which the image correlates best, from `start`; nullopt where none is found.
std::optional<Eigen::Vector2f> FindShift(const Template& patch, const WarpedPatch& warped, const ImageF& image,
                                         const Eigen::Vector2f& start) {
  const NormalizedPatch normalized = Normalized(patch, warped.by_pixel.inverse().transpose());
  if (!normalized.HasTexture(patch.total)) return std::nullopt;
  const Eigen::Matrix2f inverse = normalized.tensor.inverse();
  const auto width = static_cast<float>(image.width), height = static_cast<float>(image.height);
  std::array<float, kOffsetSamples> found;
  Eigen::Vector2f shift = start;
  for (int step = 0; step < kMaxSteps; ++step) {
    float mean = 0, product = 0, square = 0;
    for (size_t k = 0; k < kOffsetSamples; ++k) {
      const Eigen::Vector2f at = warped.at[k] + shift;
      if (patch.weight[k] > 0 && !(at.x() >= 0 && at.y() >= 0 && at.x() <= width && at.y() <= height)) {
        return std::nullopt;
      }
      found[k] = patch.weight[k] > 0 ? Bilinear(image, at.x(), at.y()) : 0;
      mean += found[k];
    }
    mean /= patch.total;
    for (size_t k = 0; k < kOffsetSamples; ++k) {
      found[k] -= mean;
      product += patch.weight[k] * found[k] * normalized.value[k];
      square += patch.weight[k] * found[k] * found[k];
    }
    const float gain = product / normalized.square;
    if (!(gain > 0)) return std::nullopt;
    Eigen::Vector2f slope(0, 0);
    for (size_t k = 0; k < kOffsetSamples; ++k) {
      slope += patch.weight[k] * (found[k] / gain - normalized.value[k]) * normalized.gradient[k];
    }
    const Eigen::Vector2f move = -(inverse * slope);
    if (!((shift + move - start).norm() < kMaxDrift)) return std::nullopt;
    shift += move;
    if (move.norm() > kFoundStep) continue;
    if (product < kMinCorrelation * std::sqrt(normalized.square * square)) return std::nullopt;
    return shift;
  }
  return std::nullopt;
}

/// Where the source view shows the pixel; nullopt where it is beyond the image, or the source's own depth says that
/// something else is there.
std::optional<Reprojection> Shown(const OffsetPixel& pixel, const Camera& view, const Camera& source,
                                  const DepthMap& map) {
  const auto seen = Reproject(view, source, {pixel.u, pixel.v, pixel.inv_depth});
  if (!seen || !(seen->at.x() >= 0 && seen->at.y() >= 0 && seen->at.x() < source.width && seen->at.y() < source.height))
    return std::nullopt;
  const size_t index =
      static_cast<size_t>(seen->at.y()) * static_cast<size_t>(source.width) + static_cast<size_t>(seen->at.x());
  const double relative = seen->depth_ratio / pixel.inv_depth * map.inv_depth[index] - 1;
  if (map.confidence[index] >= kConfident && std::abs(relative) > kOcclusion) return std::nullopt;
  return seen;
}

/// Points of the confident depths, with the views that show them.
std::vector<ScenePoint> SharedPoints(const std::vector<DepthMap>& maps) {
  std::vector<ScenePoint> points;
  for (size_t v = 0; v < maps.size(); ++v) {
    const DepthMap& map = maps[v];
    std::vector<size_t> confident;
    for (size_t i = 0; i < map.size(); ++i) {
      if (map.confidence[i] >= kConfident) confident.push_back(i);
    }
    const size_t count = std::min(kSharedPoints, confident.size());
    for (size_t k = 0; k < count; ++k) {
      const Eigen::Vector3f uvw = PixelOf(map, confident[k * confident.size() / count]);
      const OffsetPixel pixel{static_cast<int>(v), uvw.x(), uvw.y(), static_cast<double>(uvw.z()), 0, 0};
      const Eigen::Vector3d in_camera = (RayOf(map.camera, uvw.x(), uvw.y()) / uvw.z()).cast<double>();
      ScenePoint point{map.camera.cam_from_world.inverse() * in_camera, {}, {}};
      for (size_t other = 0; other < maps.size(); ++other) {
        const bool shown = other == v || Shown(pixel, map.camera, maps[other].camera, maps[other]);
        if (shown) point.views.push_back(static_cast<int>(other));
      }
      if (point.views.size() > 1) points.push_back(std::move(point));
    }
  }
  return points;
}

}  // namespace

AcrossResidual ResidualAcross(const std::vector<OffsetPixel>& pixels, const std::vector<PatchOffset>& offsets,
                              const std::vector<Camera>& cameras) {
  struct Place {
    int view, source, cell;
    auto operator<=>(const Place&) const = default;
  };
  std::map<Place, std::vector<double>> cells;
  for (const PatchOffset& offset : offsets) {
    const OffsetPixel& pixel = pixels[static_cast<size_t>(offset.pixel)];
    const Camera& camera = cameras[static_cast<size_t>(pixel.view)];
    const int column = static_cast<int>(kCellsPerSide * pixel.u / static_cast<float>(camera.width));
    const int row = static_cast<int>(kCellsPerSide * pixel.v / static_cast<float>(camera.height));
    cells[{pixel.view, offset.source, kCellsPerSide * row + column}].push_back(offset.across);
  }
  std::vector<double> all;
  std::vector<std::vector<double>> by_view(cameras.size());
  for (auto& [place, values] : cells) {
    if (values.size() < kMinCellOffsets) continue;
    all.push_back(std::abs(Median(&values)));
    by_view[static_cast<size_t>(place.view)].push_back(all.back());
    by_view[static_cast<size_t>(place.source)].push_back(all.back());
  }
  AcrossResidual residual{Median(&all), {}, all.size()};
  for (std::vector<double>& values : by_view) {
    residual.views.push_back(values.size() < kMinViewCells ? 0 : Median(&values));
  }
  return residual;
}

OffsetMeter::OffsetMeter(const std::vector<LoadedView>& views, const std::vector<DepthMap>& maps)
    : views_(views), maps_(maps), sources_(FindNeighbors(views, SharedPoints(maps), kOffsetSources)) {
  for (const LoadedView& view : views) pyramids_.push_back(PyramidOf(view.rgb));
}

std::vector<OffsetPixel> OffsetMeter::Choose(size_t most) const {
  std::vector<std::vector<OffsetPixel>> chosen(views_.size());
  ParallelFor(static_cast<int64_t>(views_.size()), [&](int64_t task) {
    const auto v = static_cast<size_t>(task);
    const DepthMap& map = maps_[v];
    if (sources_[v].empty()) return;
    std::vector<OffsetPixel> candidates;
    for (int y = kOffsetRadius; y < map.camera.height - kOffsetRadius; y += kChoiceStep) {
      for (int x = kOffsetRadius; x < map.camera.width - kOffsetRadius; x += kChoiceStep) {
        const size_t i = static_cast<size_t>(y) * map.camera.width + x;
        if (map.confidence[i] < kConfident) continue;
        const Eigen::Vector3f uvw = PixelOf(map, i), ray = RayOf(map.camera, uvw.x(), uvw.y());
        const Eigen::Vector3f& normal = map.normals[i];
        // 1/z is n'(ray) / n'X along the plane's rays, linear over the image.
        const float facing = normal.dot(ray);
        if (!(facing < 0)) continue;
        const OffsetPixel pixel{static_cast<int>(v),
                                uvw.x(),
                                uvw.y(),
                                static_cast<double>(uvw.z()),
                                normal.x() / (facing * static_cast<float>(map.camera.fx)),
                                normal.y() / (facing * static_cast<float>(map.camera.fy))};
        const Template patch = TemplateAt(pyramids_[v].front(), map, pixel, {1, 1});
        if (patch.total < kMinSamples * kOffsetSamples) continue;
        if (!Normalized(patch, Eigen::Matrix2f::Identity()).HasTexture(patch.total)) continue;
        candidates.push_back(pixel);
      }
    }
    const size_t count = std::min(most, candidates.size());
    for (size_t k = 0; k < count; ++k) chosen[v].push_back(candidates[k * candidates.size() / count]);
  });
  std::vector<OffsetPixel> pixels;
  for (const std::vector<OffsetPixel>& of_view : chosen) pixels.insert(pixels.end(), of_view.begin(), of_view.end());
  return pixels;
}

std::vector<PatchOffset> OffsetMeter::Measure(const std::vector<Camera>& cameras,
                                              const std::vector<OffsetPixel>& pixels) const {
  /// One resolution of a pair of views.
  struct PairLevel {
    PixelMap map;
    Eigen::Vector2f view_scale, source_scale;  // a pixel of the level in pixels of the full size
  };
  const auto scale_of = [&](size_t v, size_t level) {
    const ImageF& image = pyramids_[v][level];
    return Eigen::Vector2f(static_cast<float>(cameras[v].width) / static_cast<float>(image.width),
                           static_cast<float>(cameras[v].height) / static_cast<float>(image.height));
  };
  const auto camera_at = [&](size_t v, size_t level) {
    return Resized(cameras[v], pyramids_[v][level].width, pyramids_[v][level].height);
  };
  std::vector<std::vector<std::vector<PairLevel>>> pairs(cameras.size());
  for (size_t v = 0; v < cameras.size(); ++v) {
    for (const int s : sources_[v]) {
      const auto source = static_cast<size_t>(s);
      std::vector<PairLevel>& levels = pairs[v].emplace_back();
      for (size_t k = 0; k < std::min(pyramids_[v].size(), pyramids_[source].size()); ++k) {
        levels.push_back({MapBetween(camera_at(v, k), camera_at(source, k)), scale_of(v, k), scale_of(source, k)});
      }
    }
  }

  std::vector<std::optional<PatchOffset>> slots(pixels.size() * kOffsetSources);
  ParallelBlocks(static_cast<int64_t>(pixels.size()), kPixelsPerTask, [&](int64_t begin, int64_t end) {
    for (auto p = static_cast<size_t>(begin); p < static_cast<size_t>(end); ++p) {
      const OffsetPixel& pixel = pixels[p];
      const auto v = static_cast<size_t>(pixel.view);
      std::vector<Template> templates;
      for (size_t k = 0; k < pyramids_[v].size(); ++k) {
        templates.push_back(TemplateAt(pyramids_[v][k], maps_[v], pixel, scale_of(v, k)));
      }
      for (size_t s = 0; s < sources_[v].size(); ++s) {
        const auto source = static_cast<size_t>(sources_[v][s]);
        const auto expected = Shown(pixel, cameras[v], cameras[source], maps_[source]);
        if (!expected) continue;
        std::optional<Eigen::Vector2f> shift;
        Eigen::Vector2f offset(0, 0);  // full size
        for (size_t k = pairs[v][s].size(); k-- > 0;) {
          const PairLevel& level = pairs[v][s][k];
          shift.reset();
          if (templates[k].total < kMinSamples * kOffsetSamples) continue;
          const auto warped = Warped(level.map, pixel, level.view_scale);
          if (!warped) continue;
          shift = FindShift(templates[k], *warped, pyramids_[source][k], offset.cwiseQuotient(level.source_scale));
          if (shift) offset = shift->cwiseProduct(level.source_scale);
        }
        if (!shift) continue;
        const Eigen::Vector2d along = expected->by_inv_depth.normalized(), found = offset.cast<double>();
        slots[p * kOffsetSources + s] = PatchOffset{static_cast<int>(p), sources_[v][s], expected->at, found,
                                                    along.x() * found.y() - along.y() * found.x()};
      }
    }
  });
  std::vector<PatchOffset> offsets;
  for (const std::optional<PatchOffset>& slot : slots) {
    if (slot) offsets.push_back(*slot);
  }
  return offsets;
}

}  // namespace oraclegs
