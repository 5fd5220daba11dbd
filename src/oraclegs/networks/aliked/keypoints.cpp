#include "oraclegs/networks/aliked/keypoints.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace oraclegs::aliked {
namespace {

constexpr int64_t kRadius = 2;
constexpr float kTemperature = 0.1f;

/// The largest number within kRadius.
Tensor Dilated(const Tensor& map) { return at::max_pool2d(map, 2 * kRadius + 1, 1, kRadius); }

/// Which pixels are maxima, [H, W] of bytes. A maximum suppresses all around it; among those that no maximum reaches,
/// twice, new ones are found.
Tensor LocalMaxima(const Tensor& scores) {
  const Tensor map = scores.view({1, 1, scores.size(0), scores.size(1)});
  Tensor maxima = map == Dilated(map);
  for (int round = 0; round < 2; ++round) {
    const Tensor suppressed = Dilated(maxima.to(torch::kFloat)) > 0;
    const Tensor rest = map.masked_fill(suppressed, 0);
    maxima = maxima.logical_or((rest == Dilated(rest)).logical_and(suppressed.logical_not()));
  }
  return maxima[0][0].to(torch::kByte).contiguous();
}

class ScoreMap {
 public:
  explicit ScoreMap(const Tensor& scores) : values_(scores.data_ptr<float>()), width_(scores.size(1)) {}

  float At(int64_t x, int64_t y) const { return values_[y * width_ + x]; }

  /// The score between four pixels, of a place above the last row and left of the last column.
  float Between(const Eigen::Vector2f& place) const {
    const auto x = static_cast<int64_t>(place.x()), y = static_cast<int64_t>(place.y());
    const float u = place.x() - static_cast<float>(x), v = place.y() - static_cast<float>(y);
    return (1 - v) * ((1 - u) * At(x, y) + u * At(x + 1, y)) + v * ((1 - u) * At(x, y + 1) + u * At(x + 1, y + 1));
  }

  Eigen::Vector2f Refined(int64_t x, int64_t y) const {
    float best = 0, total = 0;
    for (int64_t i = -kRadius; i <= kRadius; ++i) {
      for (int64_t j = -kRadius; j <= kRadius; ++j) best = std::max(best, At(x + j, y + i));
    }
    Eigen::Vector2f shift = Eigen::Vector2f::Zero();
    for (int64_t i = -kRadius; i <= kRadius; ++i) {
      for (int64_t j = -kRadius; j <= kRadius; ++j) {
        const float weight = std::exp((At(x + j, y + i) - best) / kTemperature);
        shift += weight * Eigen::Vector2f(static_cast<float>(j), static_cast<float>(i));
        total += weight;
      }
    }
    return Eigen::Vector2f(static_cast<float>(x), static_cast<float>(y)) + shift / total;
  }

 private:
  const float* values_;
  int64_t width_;
};

struct Peak {
  float score;
  int64_t x, y;
};

}  // namespace

std::vector<Keypoint> FindKeypoints(const Tensor& scores, const KeypointOptions& options) {
  RequireFloat("FindKeypoints", "scores", scores, {-1, -1});
  const int64_t height = scores.size(0), width = scores.size(1);
  const ScoreMap map(scores);
  const Tensor maxima = LocalMaxima(scores);
  const auto* is_maximum = maxima.data_ptr<uint8_t>();
  std::vector<Peak> peaks;
  for (int64_t y = kRadius; y < height - kRadius; ++y) {
    for (int64_t x = kRadius; x < width - kRadius; ++x) {
      const float score = map.At(x, y);
      if (is_maximum[y * width + x] != 0 && score > options.min_score) peaks.push_back({score, x, y});
    }
  }
  std::stable_sort(peaks.begin(), peaks.end(), [](const Peak& a, const Peak& b) { return a.score > b.score; });
  peaks.resize(std::min(peaks.size(), static_cast<size_t>(options.max_keypoints)));
  std::vector<Keypoint> keypoints;
  for (const Peak& peak : peaks) {
    const Eigen::Vector2f place = map.Refined(peak.x, peak.y);
    keypoints.push_back({place, map.Between(place)});
  }
  return keypoints;
}

}  // namespace oraclegs::aliked
