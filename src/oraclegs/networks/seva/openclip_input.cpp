#include "oraclegs/networks/seva/openclip_input.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "oraclegs/networks/common/layers.h"

namespace oraclegs::seva {
namespace {

/// Sums shifted copies: libtorch's convolution may split its sum by the number of threads.
Tensor BlurAxis(const Tensor& x, int64_t axis, const std::vector<double>& weights) {
  const int64_t reach = static_cast<int64_t>(weights.size()) / 2, length = x.size(axis);
  const std::vector<int64_t> border =
      axis == 3 ? std::vector<int64_t>{reach, reach, 0, 0} : std::vector<int64_t>{0, 0, reach, reach};
  const Tensor padded = at::reflection_pad2d(x, border);
  Tensor sum = padded.narrow(axis, 0, length) * weights[0];
  for (size_t i = 1; i < weights.size(); ++i) {
    sum.add_(padded.narrow(axis, static_cast<int64_t>(i), length), weights[i]);
  }
  return sum;
}

}  // namespace

std::vector<double> ResizeBlurWeights(int64_t length, int64_t side) {
  const double factor = static_cast<double>(length) / static_cast<double>(side);
  const double sigma = std::max((factor - 1) / 2, 0.001);
  int64_t taps = static_cast<int64_t>(std::max(4 * sigma, 3.0));
  if (taps % 2 == 0) ++taps;
  std::vector<double> weights;
  double sum = 0;
  for (int64_t i = 0; i < taps; ++i) {
    const double distance = static_cast<double>(i - taps / 2) / sigma;
    weights.push_back(std::exp(-distance * distance / 2));
    sum += weights.back();
  }
  for (double& weight : weights) weight /= sum;
  return weights;
}

Tensor BlurForResize(const Tensor& x, int64_t side) {
  const int64_t height = x.size(2), width = x.size(3);
  if (std::max(height, width) <= side) return x;
  return BlurAxis(BlurAxis(x, 3, ResizeBlurWeights(width, side)), 2, ResizeBlurWeights(height, side));
}

Tensor PrepareOpenClipInput(const Tensor& images, int64_t side) {
  RequireImages("PrepareOpenClipInput", images, 1);
  if (images.size(2) < 2 || images.size(3) < 2) {
    throw ShapeError("PrepareOpenClipInput: the images are {} x {}, expected 2 pixels a side at least", images.size(3),
                     images.size(2));
  }
  const Tensor resized = at::upsample_bicubic2d(BlurForResize(images, side).contiguous(), {side, side}, true);
  const auto constant = [&](float r, float g, float b) {
    return torch::tensor({r, g, b}).view({1, 3, 1, 1}).to(images.options());
  };
  const Tensor mean = constant(0.48145466f, 0.4578275f, 0.40821073f);
  const Tensor deviation = constant(0.26862954f, 0.26130258f, 0.27577711f);
  return ((resized + 1) / 2 - mean) / deviation;
}

}  // namespace oraclegs::seva
