#include "oraclegs/train/coarse.h"

#include <algorithm>

#include "oraclegs/image/image.h"

namespace oraclegs {
namespace {

struct Size {
  int width, height;
};

/// Resizes [H,W] or [H,W,C] by area averages.
Buffer<float> Resize(const Buffer<float>& image, Size size) {
  const int channels = image.dims() == 3 ? static_cast<int>(image.size(2)) : 1;
  ImageF full{static_cast<int>(image.size(1)), static_cast<int>(image.size(0)), channels, {}};
  full.data.assign(image.data(), image.data() + image.count());
  const ImageF small = ResizeArea(full, size.width, size.height);
  Buffer<float> result = Buffer<float>::Empty(image.dims() == 3 ? Shape{size.height, size.width, channels}
                                                                : Shape{size.height, size.width});
  std::copy(small.data.begin(), small.data.end(), result.data());
  return result;
}

/// Averages `image` ([H,W] or [H,W,C]) with `weights` [H,W], whose own average is `small_weights`.
Buffer<float> ResizeWeighted(const Buffer<float>& image, const Buffer<float>& weights,
                             const Buffer<float>& small_weights) {
  Buffer<float> product = image.Clone();
  const int64_t channels = image.count() / weights.count();
  const auto scale = [channels](const Buffer<float>& t, const Buffer<float>& by, auto&& op) {
    float* values = t.data();
    const float* w = by.data();
    for (int64_t i = 0; i < by.count(); ++i) {
      for (int64_t c = 0; c < channels; ++c) values[i * channels + c] = op(values[i * channels + c], w[i]);
    }
  };
  scale(product, weights, [](float value, float weight) { return weight > 0 ? value * weight : 0; });
  Buffer<float> small =
      Resize(product, {static_cast<int>(small_weights.size(1)), static_cast<int>(small_weights.size(0))});
  scale(small, small_weights, [](float value, float weight) { return weight > 0 ? value / weight : 0; });
  return small;
}

}  // namespace

TrainView HalfSize(const TrainView& view, ViewKind kind) {
  const Size size{(view.camera.width + 1) / 2, (view.camera.height + 1) / 2};
  TrainView half = view;
  half.camera = Resized(view.camera, size.width, size.height);
  if (view.confidence.defined()) {
    half.confidence = Resize(view.confidence, size);
    half.image = ResizeWeighted(view.image, view.confidence, half.confidence);
    if (kind == ViewKind::kProposal) {
      const Buffer<float> plain = Resize(view.image, size);
      for (int64_t i = 0; i < plain.count(); ++i) {
        if (!(half.confidence[i / 3] > 0)) half.image[i] = plain[i];
      }
    }
  } else {
    half.image = Resize(view.image, size);
  }
  if (view.alpha.defined()) {
    half.alpha = view.confidence.defined() ? ResizeWeighted(view.alpha, view.confidence, half.confidence)
                                           : Resize(view.alpha, size);
  }
  if (view.inv_depth.defined()) {
    half.depth_mask = Resize(view.depth_mask, size);
    half.inv_depth = ResizeWeighted(view.inv_depth, view.depth_mask, half.depth_mask);
  }
  return half;
}

int64_t CoarseIterations(double coarse_share, int64_t iterations) {
  const auto share = static_cast<int64_t>(coarse_share * static_cast<double>(iterations));
  return std::clamp<int64_t>(share, 0, iterations - 1);
}

}  // namespace oraclegs
