#include "oraclegs/validate/picture_check.h"

#include <algorithm>
#include <cmath>

#include "oraclegs/core/error.h"

namespace oraclegs {
namespace {

constexpr int kSmallSide = 96;                             // image side at which gross content is compared, pixels
constexpr int kCell = 8;                                   // side, pixels
constexpr size_t kMinCells = 12;                           // cells with texture, below which nothing is decided
constexpr double kMinKnown = 0.75;                         // share of a cell that views must show
constexpr double kMinTexture = 0.02, kNoiseLevel = 0.005;  // deviations of brightness
constexpr double kMinCorrelation = 0.5;
constexpr double kWrongShare = 0.9;  // quantile of the wrong pictures' agreement that becomes the least agreement
constexpr double kRightShare = 0.1;  // quantile of the right pictures' agreement
constexpr double kMaxOfRight = 0.4;  // limit of the least agreement, as a factor of that quantile

float Brightness(const float* rgb) { return 0.299f * rgb[0] + 0.587f * rgb[1] + 0.114f * rgb[2]; }

/// Brightness of the picture, brightness of the warp, and 1 where views show the surface; reduced in size.
ImageF Gather(const ImageF& picture, const WarpedView& warped) {
  ImageF gathered = picture;
  for (size_t i = 0; i < picture.data.size() / 3; ++i) {
    const PixelEvidence& evidence = warped.evidence[i];
    gathered.data[3 * i] = Brightness(&picture.data[3 * i]);
    gathered.data[3 * i + 1] = Brightness(&warped.rgb.data[3 * i]);
    gathered.data[3 * i + 2] = evidence.ring == 0 && evidence.views > 0.5f ? 1.f : 0.f;
  }
  const double scale = std::min(1.0, static_cast<double>(kSmallSide) / std::min(picture.width, picture.height));
  return ResizeArea(gathered, std::max(1, static_cast<int>(std::lround(picture.width * scale))),
                    std::max(1, static_cast<int>(std::lround(picture.height * scale))));
}

/// True when a cell agrees in structure; nullopt when it is mostly unseen or has no texture.
std::optional<bool> Agrees(const ImageF& gathered, int left, int top) {
  double known = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0;
  for (int y = top; y < top + kCell; ++y) {
    for (int x = left; x < left + kCell; ++x) {
      const float* p = gathered.row(y) + size_t{3} * static_cast<size_t>(x);
      const auto u = static_cast<double>(p[0]), v = static_cast<double>(p[1]);
      known += static_cast<double>(p[2]);
      a += u, b += v, aa += u * u, bb += v * v, ab += u * v;
    }
  }
  constexpr double kPixels = double{kCell} * kCell;
  const double var_a = std::max(0.0, aa / kPixels - a * a / kPixels / kPixels);
  const double var_b = std::max(0.0, bb / kPixels - b * b / kPixels / kPixels);
  if (known < kMinKnown * kPixels || var_b < kMinTexture * kMinTexture) return std::nullopt;
  const double covariance = ab / kPixels - a * b / kPixels / kPixels;
  return covariance > kMinCorrelation * std::sqrt((var_a + kNoiseLevel * kNoiseLevel) * var_b);
}

/// Value below which `share` of the values lie; requires at least one value.
double ValueAt(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<size_t>(share * static_cast<double>(values.size() - 1) + 0.5)];
}

}  // namespace

std::optional<double> Agreement(const ImageF& picture, const WarpedView& warped) {
  if (picture.data.size() != warped.rgb.data.size() || picture.width != warped.rgb.width) {
    throw ShapeError("Agreement: {} x {} with {} x {} pixels", picture.width, picture.height, warped.rgb.width,
                     warped.rgb.height);
  }
  const ImageF gathered = Gather(picture, warped);
  size_t cells = 0, agreeing = 0;
  for (int top = 0; top + kCell <= gathered.height; top += kCell) {
    for (int left = 0; left + kCell <= gathered.width; left += kCell) {
      const std::optional<bool> agrees = Agrees(gathered, left, top);
      cells += agrees ? 1 : 0;
      agreeing += agrees.value_or(false) ? 1 : 0;
    }
  }
  if (cells < kMinCells) return std::nullopt;
  return static_cast<double>(agreeing) / static_cast<double>(cells);
}

void PictureCheck::Learn(std::vector<double> right, std::vector<double> wrong) {
  least_ = 0;
  if (right.empty() || wrong.empty()) return;
  const double of_right = ValueAt(std::move(right), kRightShare), of_wrong = ValueAt(std::move(wrong), kWrongShare);
  least_ = std::min(kMaxOfRight * of_right, (of_right + of_wrong) / 2);
}

}  // namespace oraclegs
