#include "oraclegs/depth/patch_search.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "oraclegs/core/parallel.h"
#include "oraclegs/depth/patch_cost.h"

namespace oraclegs {
namespace {

constexpr int kCoarsestSide = 60;         // pixels: the smaller side of the coarsest resolution, at least
constexpr size_t kSearchLevels = 3;       // full, half and quarter size
constexpr float kSamePlane = 0.05f;       // relative distance of a depth from its patch's plane
constexpr float kMinSamples = 0.6f;       // share of a patch's pixels that lie on its plane
constexpr float kMinSlope = 3;            // 8-bit units per pixel, RMS in the direction with the least
constexpr float kMinCorrelation = 0.85f;  // of the patch that is found
constexpr int kMaxSearchSteps = 12;
constexpr float kFoundStep = 0.02f;                // pixels: a smaller step ends the search
constexpr float kMaxDrift = 3;                     // pixels from the start
constexpr float kMinScale = 0.25f, kMaxScale = 4;  // area of a pixel in the other image

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

/// A patch whose values and gradients are free of what a change of gain and offset of brightness does.
struct NormalizedPatch {
  std::array<float, kSearchSamples> value;               ///< weighted mean 0
  std::array<Eigen::Vector2f, kSearchSamples> gradient;  ///< by the source view's pixels
  float square = 0;                                      ///< weighted sum of squares of `value`
  Eigen::Matrix2f tensor = Eigen::Matrix2f::Zero();      ///< weighted sum of the gradients' outer products

  bool HasTexture(float total) const {
    const float mean = 0.5f * tensor.trace();
    const float least = mean - std::sqrt(std::max(0.f, mean * mean - tensor.determinant()));
    return square > 0 && least > kMinSlope * kMinSlope * total;
  }
};

NormalizedPatch Normalized(const SearchPatch& patch, const Eigen::Matrix2f& gradient_map) {
  NormalizedPatch out;
  float mean = 0;
  Eigen::Vector2f mean_gradient(0, 0), slope(0, 0);
  for (size_t k = 0; k < kSearchSamples; ++k) {
    out.gradient[k] = gradient_map * patch.gradient[k];
    mean += patch.weight[k] * patch.value[k];
    mean_gradient += patch.weight[k] * out.gradient[k];
  }
  mean /= patch.total;
  mean_gradient /= patch.total;
  for (size_t k = 0; k < kSearchSamples; ++k) {
    out.value[k] = patch.value[k] - mean;
    out.gradient[k] -= mean_gradient;
    out.square += patch.weight[k] * out.value[k] * out.value[k];
    slope += patch.weight[k] * out.value[k] * out.gradient[k];
  }
  if (!(out.square > 0)) return out;
  slope /= out.square;
  for (size_t k = 0; k < kSearchSamples; ++k) {
    out.gradient[k] -= out.value[k] * slope;
    out.tensor += patch.weight[k] * out.gradient[k] * out.gradient[k].transpose();
  }
  return out;
}

}  // namespace

std::vector<ImageF> SearchPyramid(const ImageF& rgb) {
  std::vector<ImageF> levels;
  ImageF gray = Luma(rgb);
  while (true) {
    levels.push_back(Smoothed(gray));
    if (levels.size() == kSearchLevels || std::min(gray.width, gray.height) < 2 * kCoarsestSide) return levels;
    gray = ResizeArea(gray, gray.width / 2, gray.height / 2);
  }
}

SearchPatch SearchPatchAt(const ImageF& image, const DepthMap& map, const OffsetPixel& pixel,
                          const Eigen::Vector2f& scale) {
  constexpr int kSide = kSearchSide + 2;
  std::array<float, kSide * kSide> values;
  const float u = pixel.u / scale.x(), v = pixel.v / scale.y();
  for (int j = 0; j < kSide; ++j) {
    for (int i = 0; i < kSide; ++i) {
      values[static_cast<size_t>(j * kSide + i)] =
          Bilinear(image, u + static_cast<float>(i - kSearchRadius - 1), v + static_cast<float>(j - kSearchRadius - 1));
    }
  }
  SearchPatch patch;
  for (int j = 0; j < kSearchSide; ++j) {
    for (int i = 0; i < kSearchSide; ++i) {
      const auto k = static_cast<size_t>(j * kSearchSide + i);
      const float* at = &values[static_cast<size_t>((j + 1) * kSide + i + 1)];
      patch.value[k] = *at;
      patch.gradient[k] = 0.5f * Eigen::Vector2f(at[1] - at[-1], at[kSide] - at[-kSide]);
      const float dx = static_cast<float>(i - kSearchRadius) * scale.x();
      const float dy = static_cast<float>(j - kSearchRadius) * scale.y();
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

bool SearchPatch::IsSurface() const { return total >= kMinSamples * kSearchSamples; }

bool SearchPatch::HasTexture() const {
  return total > 0 && Normalized(*this, Eigen::Matrix2f::Identity()).HasTexture(total);
}

std::optional<WarpedPatch> WarpPatch(const PixelMap& map, const OffsetPixel& pixel, const Eigen::Vector2f& scale) {
  const auto w = static_cast<float>(pixel.inv_depth);
  const Eigen::Vector3f base = map(pixel.u / scale.x(), pixel.v / scale.y(), w);
  const Eigen::Vector3f right = map.rotation.col(0) + map.translation * (w * pixel.slope_x * scale.x());
  const Eigen::Vector3f down = map.rotation.col(1) + map.translation * (w * pixel.slope_y * scale.y());
  const float reach = kSearchRadius * (std::abs(right.z()) + std::abs(down.z()));
  if (!(base.z() > 0) || !(reach < 0.5f * base.z())) return std::nullopt;
  WarpedPatch warped;
  const Eigen::Vector2f center = base.head<2>() / base.z();
  warped.by_pixel.col(0) = (right.head<2>() - center * right.z()) / base.z();
  warped.by_pixel.col(1) = (down.head<2>() - center * down.z()) / base.z();
  const float area = warped.by_pixel.determinant();
  if (!(area > kMinScale && area < kMaxScale)) return std::nullopt;
  for (int j = 0; j < kSearchSide; ++j) {
    for (int i = 0; i < kSearchSide; ++i) {
      const Eigen::Vector3f q =
          base + right * static_cast<float>(i - kSearchRadius) + down * static_cast<float>(j - kSearchRadius);
      warped.at[static_cast<size_t>(j * kSearchSide + i)] = q.head<2>() / q.z();
    }
  }
  return warped;
}

std::optional<Eigen::Vector2f> FindPatch(const SearchPatch& patch, const WarpedPatch& warped, const ImageF& image,
                                         const Eigen::Vector2f& start) {
  const NormalizedPatch normalized = Normalized(patch, warped.by_pixel.inverse().transpose());
  if (!normalized.HasTexture(patch.total)) return std::nullopt;
  const Eigen::Matrix2f inverse = normalized.tensor.inverse();
  const auto width = static_cast<float>(image.width), height = static_cast<float>(image.height);
  std::array<float, kSearchSamples> found;
  Eigen::Vector2f shift = start;
  for (int step = 0; step < kMaxSearchSteps; ++step) {
    float mean = 0, product = 0, square = 0;
    for (size_t k = 0; k < kSearchSamples; ++k) {
      const Eigen::Vector2f at = warped.at[k] + shift;
      if (patch.weight[k] > 0 && !(at.x() >= 0 && at.y() >= 0 && at.x() <= width && at.y() <= height)) {
        return std::nullopt;
      }
      found[k] = patch.weight[k] > 0 ? Bilinear(image, at.x(), at.y()) : 0;
      mean += found[k];
    }
    mean /= patch.total;
    for (size_t k = 0; k < kSearchSamples; ++k) {
      found[k] -= mean;
      product += patch.weight[k] * found[k] * normalized.value[k];
      square += patch.weight[k] * found[k] * found[k];
    }
    const float gain = product / normalized.square;
    if (!(gain > 0)) return std::nullopt;
    Eigen::Vector2f slope(0, 0);
    for (size_t k = 0; k < kSearchSamples; ++k) {
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

}  // namespace oraclegs
