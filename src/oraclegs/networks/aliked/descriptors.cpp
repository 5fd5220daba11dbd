#include "oraclegs/networks/aliked/descriptors.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "oraclegs/core/parallel.h"

namespace oraclegs::aliked {
namespace {

constexpr float kLengthFloor = 1e-12f;
constexpr int64_t kPatch = 3, kKeypointsATask = 32;

/// The features of single pixels of the image: the four maps there, enlarged with corners aligned and stacked, at unit
/// length. They are made when they are asked for, because all of them are 512 bytes a pixel. Zero outside the image.
class PixelFeatures {
 public:
  explicit PixelFeatures(const FeatureMaps& maps)
      : height_(maps.scores.size(0)), width_(maps.scores.size(1)), left_(maps.left), top_(maps.top) {
    for (size_t i = 0; i < 4; ++i) {
      maps_[i] = maps.maps[i][0].permute({1, 2, 0}).contiguous().to(torch::kCPU);
      const auto scale = [&](int64_t axis) {
        const auto most = static_cast<float>(std::max<int64_t>(maps_[0].size(axis) - 1, 1));
        return static_cast<float>(maps_[i].size(axis) - 1) / most;
      };
      scale_y_[i] = scale(0), scale_x_[i] = scale(1);
    }
    channels_ = maps_[0].size(2);
  }

  int64_t size() const { return 4 * channels_; }
  int64_t height() const { return height_; }
  int64_t width() const { return width_; }

  void Read(int64_t x, int64_t y, float* out) const {
    if (x < 0 || y < 0 || x >= width_ || y >= height_) {
      std::fill_n(out, size(), 0.f);
      return;
    }
    for (size_t i = 0; i < 4; ++i) {
      ReadMap(i, static_cast<float>(x + left_), static_cast<float>(y + top_),
              out + static_cast<int64_t>(i) * channels_);
    }
    float length = 0;
    for (int64_t c = 0; c < size(); ++c) length += out[c] * out[c];
    const float scale = 1 / std::max(std::sqrt(length), kLengthFloor);
    for (int64_t c = 0; c < size(); ++c) out[c] *= scale;
  }

  /// Between four pixels, into `out`; `scratch` has room for one.
  void ReadBetween(float x, float y, float* scratch, float* out) const {
    std::fill_n(out, size(), 0.f);
    const float x0 = std::floor(x), y0 = std::floor(y);
    for (int corner = 0; corner < 4; ++corner) {
      const int right = corner % 2, below = corner / 2;
      const float u = right == 1 ? x - x0 : x0 + 1 - x, v = below == 1 ? y - y0 : y0 + 1 - y;
      Read(static_cast<int64_t>(x0) + right, static_cast<int64_t>(y0) + below, scratch);
      for (int64_t c = 0; c < size(); ++c) out[c] += u * v * scratch[c];
    }
  }

 private:
  void ReadMap(size_t i, float x, float y, float* out) const {
    const int64_t height = maps_[i].size(0), width = maps_[i].size(1);
    const float at_x = x * scale_x_[i], at_y = y * scale_y_[i];
    const int64_t x0 = std::min(static_cast<int64_t>(at_x), width - 1), x1 = std::min(x0 + 1, width - 1);
    const int64_t y0 = std::min(static_cast<int64_t>(at_y), height - 1), y1 = std::min(y0 + 1, height - 1);
    const float u = at_x - static_cast<float>(x0), v = at_y - static_cast<float>(y0);
    const float* values = maps_[i].data_ptr<float>();
    const auto pixel = [&](int64_t column, int64_t row) { return values + (row * width + column) * channels_; };
    const std::array<const float*, 4> corners = {pixel(x0, y0), pixel(x1, y0), pixel(x0, y1), pixel(x1, y1)};
    const std::array<float, 4> weights = {(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v};
    for (int64_t c = 0; c < channels_; ++c) {
      out[c] = weights[0] * corners[0][c] + weights[1] * corners[1][c] + weights[2] * corners[2][c] +
               weights[3] * corners[3][c];
    }
  }

  std::array<Tensor, 4> maps_;  // [rows, columns, channels]
  std::array<float, 4> scale_x_{}, scale_y_{};
  int64_t channels_ = 0, height_, width_, left_, top_;
};

/// The 3x3 pixels around each keypoint, [N, 3, 3, size].
Tensor Patches(const PixelFeatures& features, const std::vector<Keypoint>& keypoints) {
  const auto count = static_cast<int64_t>(keypoints.size());
  const Tensor patches = torch::empty({count, kPatch, kPatch, features.size()}, torch::kFloat);
  ParallelBlocks(count, kKeypointsATask, [&](int64_t begin, int64_t end) {
    float* out = patches.data_ptr<float>() + begin * kPatch * kPatch * features.size();
    for (int64_t i = begin; i < end; ++i) {
      const Eigen::Vector2f& place = keypoints[static_cast<size_t>(i)].place;
      for (int64_t y = -1; y <= 1; ++y) {
        for (int64_t x = -1; x <= 1; ++x, out += features.size()) {
          features.Read(static_cast<int64_t>(place.x()) + x, static_cast<int64_t>(place.y()) + y, out);
        }
      }
    }
  });
  return patches;
}

/// Features [N * samples, size] at the keypoints' places and `offsets` [N, 2, samples] from there.
Tensor Samples(const PixelFeatures& features, const std::vector<Keypoint>& keypoints, const Tensor& offsets) {
  const int64_t count = offsets.size(0), samples = offsets.size(2);
  const Tensor values = torch::empty({count * samples, features.size()}, torch::kFloat);
  ParallelBlocks(count, kKeypointsATask, [&](int64_t begin, int64_t end) {
    std::vector<float> scratch(static_cast<size_t>(features.size()));
    float* out = values.data_ptr<float>() + begin * samples * features.size();
    for (int64_t i = begin; i < end; ++i) {
      const Eigen::Vector2f& place = keypoints[static_cast<size_t>(i)].place;
      const float* shift = offsets.data_ptr<float>() + 2 * i * samples;
      for (int64_t s = 0; s < samples; ++s, out += features.size()) {
        features.ReadBetween(place.x() + shift[s], place.y() + shift[samples + s], scratch.data(), out);
      }
    }
  });
  return values;
}

}  // namespace

DescriptorHead LoadDescriptorHead(const ParameterScope& at, const AlikedConfig& config) {
  const int64_t size = config.descriptor_size(), outputs = 2 * config.samples;
  const ParameterScope offsets = at / "offset_conv", second = offsets / 2;
  DescriptorHead head;
  head.config = config;
  head.offsets = LoadConv(offsets / 0, {.in = size, .out = outputs, .padding = 0});
  head.offsets2 = {second.Get("weight", {outputs, outputs, 1, 1}), second.Get("bias", {outputs})};
  head.feature_weight = (at / "sf_conv").Get("weight", {size, size, 1, 1});
  head.sample_weights = at.Get("agg_weights", {config.samples, size, size});
  return head;
}

Tensor Describe(const DescriptorHead& head, const FeatureMaps& maps, const std::vector<Keypoint>& keypoints) {
  const auto count = static_cast<int64_t>(keypoints.size());
  const int64_t size = head.config.descriptor_size(), samples = head.config.samples;
  if (count == 0) return torch::empty({0, size}, torch::kFloat);
  const PixelFeatures features(maps);
  const double reach = static_cast<double>(std::max(features.height(), features.width())) / 4;
  const auto here = [](const Tensor& weight) { return weight.to(torch::kCPU); };
  const Tensor kernel = here(head.offsets.weight).permute({0, 2, 3, 1}).reshape({2 * samples, -1});
  Tensor hidden = at::linear(Patches(features, keypoints).view({count, -1}), kernel, here(head.offsets.bias));
  hidden = at::linear(at::selu_(hidden), here(head.offsets2.weight).flatten(1), here(head.offsets2.bias));
  const Tensor offsets = hidden.clamp_(-reach, reach).view({count, 2, samples});
  Tensor values = at::linear(Samples(features, keypoints, offsets), here(head.feature_weight).flatten(1));
  values = at::selu_(values).view({count, samples * size});
  const Tensor descriptors = at::mm(values, here(head.sample_weights).view({samples * size, size}));
  return descriptors / descriptors.norm(2, {1}, true).clamp_min(kLengthFloor);
}

}  // namespace oraclegs::aliked
