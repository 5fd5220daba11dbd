#include "oraclegs/train/train_view.h"

#include <algorithm>
#include <cmath>

#include "oraclegs/core/parallel.h"
#include "oraclegs/core/statistics.h"

namespace oraclegs {
namespace {

bool DepthCounts(const TrainView& view, int64_t pixel) {
  if (!(view.depth_mask.data()[pixel] > 0)) return false;
  if (view.weight_bytes.defined()) return view.weight_bytes.data()[pixel] > 0;
  return !view.pixel_weight.defined() || view.pixel_weight.data()[pixel] > 0;
}

void CheckDepth(const TrainView& view) {
  if (!view.inv_depth.defined() && !view.depth_mask.defined()) return;
  const int64_t height = view.camera.height, width = view.camera.width;
  RequireShape("Trainer", ("inv_depth of " + view.name).c_str(), view.inv_depth, {height, width});
  RequireShape("Trainer", ("depth_mask of " + view.name).c_str(), view.depth_mask, {height, width});
  const float* inv_depth = view.inv_depth.data();
  for (int64_t i = 0; i < height * width; ++i) {
    if (DepthCounts(view, i) && !std::isfinite(inv_depth[i])) {
      throw ShapeError("Trainer: inv_depth of {} is {} at column {}, row {}, where depth_mask counts it", view.name,
                       inv_depth[i], i % width, i / width);
    }
  }
}

void CheckShares(const TrainView& view, const char* what, const Buffer<float>& shares) {
  const float* values = shares.data();
  for (int64_t i = 0; i < shares.count(); ++i) {
    if (values[i] >= 0 && values[i] <= 1) continue;
    throw ShapeError("Trainer: {} of {} is {} at column {}, row {}, must be in 0 .. 1", what, view.name, values[i],
                     i % view.camera.width, i / view.camera.width);
  }
}

void RequirePlane(const std::string& view, const char* what, const Buffer<float>& floats, const Buffer<uint8_t>& bytes,
                  std::initializer_list<int64_t> shape) {
  if (floats.defined() && bytes.defined()) throw ShapeError("Trainer: {} of {} stand twice", what, view);
  const std::string name = fmt::format("{} of {}", what, view);
  if (bytes.defined()) {
    RequireShape("Trainer", name.c_str(), bytes, shape);
  } else {
    RequireShape("Trainer", name.c_str(), floats, shape);
  }
}

void CheckView(const TrainView& view) {
  const int64_t height = view.camera.height, width = view.camera.width;
  RequirePlane(view.name, "image", view.image, view.image_bytes, {height, width, 3});
  if (view.HasWeights()) {
    RequirePlane(view.name, "pixel weights", view.pixel_weight, view.weight_bytes, {height, width});
  }
  CheckDepth(view);
  if (!view.alpha.defined()) return;
  RequireShape("Trainer", ("alpha of " + view.name).c_str(), view.alpha, {height, width});
  CheckShares(view, "alpha", view.alpha);
}

/// One channel of a photo, which has one number per pixel.
template <class T>
Buffer<float> Plane(const std::vector<T>& values, const char* what, const LoadedView& photo) {
  const int64_t height = photo.rgb.height, width = photo.rgb.width;
  if (values.size() != static_cast<size_t>(height * width)) {
    throw ShapeError("ToTrainView: the {} of {} has {} pixels, expected {}", what, photo.name, values.size(),
                     height * width);
  }
  Buffer<float> plane = Buffer<float>::Empty({height, width});
  std::copy(values.begin(), values.end(), plane.data());
  return plane;
}

Buffer<float> Unpacked(const Buffer<uint8_t>& bytes) {
  Buffer<float> floats = Buffer<float>::Empty(bytes.shape());
  UnpackBytes(bytes, floats);
  return floats;
}

}  // namespace

Buffer<float> TrainView::Image() const { return image_bytes.defined() ? Unpacked(image_bytes) : image; }

Buffer<float> TrainView::Weights() const { return weight_bytes.defined() ? Unpacked(weight_bytes) : pixel_weight; }

void UnpackBytes(const Buffer<uint8_t>& bytes, const Buffer<float>& to) {
  constexpr int64_t kGrain = 1 << 16;
  const uint8_t* from = bytes.data();
  float* values = to.data();
  ParallelBlocks(bytes.count(), kGrain, [=](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) values[i] = static_cast<float>(from[i]) / 255;
  });
}

TrainView ToTrainView(const LoadedView& photo, std::shared_ptr<const void> owner) {
  TrainView view{photo.name, photo.camera, {}, {}};
  const int64_t height = photo.rgb.height, width = photo.rgb.width;
  if (photo.rgb.channels != 3 || photo.rgb.data.size() != static_cast<size_t>(height * width * 3)) {
    throw ShapeError("ToTrainView: {} has {} channels, expected 3", photo.name, photo.rgb.channels);
  }
  if (owner) {
    auto* pixels = const_cast<float*>(photo.rgb.data.data());  // no trainer writes to it
    view.image = Buffer<float>::Wrap(pixels, {height, width, 3}, kCpu, std::move(owner));
  } else {
    view.image = Buffer<float>::From({height, width, 3}, std::span<const float>(photo.rgb.data));
  }
  if (!photo.weights.empty()) {
    view.pixel_weight = Plane(photo.weights, "weights", photo);
  } else if (!photo.mask.empty()) {
    view.pixel_weight = Plane(photo.mask, "mask", photo);
  }
  if (!photo.alpha.empty()) view.alpha = Plane(photo.alpha, "alpha channel", photo);
  return view;
}

void CheckViews(const std::vector<TrainView>& views) {
  if (views.empty()) throw UsageError("there is no photo to train on");
  for (const TrainView& view : views) CheckView(view);
}

void CheckProposals(const std::vector<TrainView>& proposals) {
  for (const TrainView& view : proposals) {
    CheckView(view);
    if (view.pixel_weight.defined()) CheckShares(view, "confidence", view.pixel_weight);
  }
}

TrainView WithConfidencePower(TrainView proposal, double power) {
  if (!proposal.HasWeights() || power == 1) return proposal;  // 1 stays 1
  proposal.pixel_weight = proposal.Weights().Clone();
  proposal.weight_bytes = {};
  float* u = proposal.pixel_weight.data();
  for (int64_t i = 0; i < proposal.pixel_weight.count(); ++i) {
    u[i] = u[i] > 0 ? static_cast<float>(std::pow(static_cast<double>(u[i]), power)) : 0.f;
  }
  return proposal;
}

double MeanConfidence(const TrainView& view) {
  if (!view.HasWeights()) return 1;
  const Buffer<float> confidence = view.Weights();
  double sum = 0;
  for (const float u : confidence.span()) sum += static_cast<double>(u);
  return sum / static_cast<double>(confidence.count());
}

std::vector<Camera> Cameras(const std::vector<TrainView>& views) {
  std::vector<Camera> cameras;
  for (const TrainView& view : views) cameras.push_back(view.camera);
  return cameras;
}

TrainView WithCleanDepth(TrainView view) {
  if (!view.inv_depth.defined()) return view;
  const Buffer<float> inv_depth = view.inv_depth.Clone(), mask = view.depth_mask.Clone();
  bool counts = false;
  for (int64_t i = 0; i < mask.count(); ++i) {
    if (DepthCounts(view, i)) {
      counts = true;
    } else {
      inv_depth.data()[i] = mask.data()[i] = 0;
    }
  }
  view.inv_depth = counts ? inv_depth : Buffer<float>();
  view.depth_mask = counts ? mask : Buffer<float>();
  return view;
}

double CharacteristicDepth(const std::vector<TrainView>& views) {
  std::vector<float> medians, known;
  for (const TrainView& view : views) {
    if (!view.inv_depth.defined()) continue;
    const float *inv_depth = view.inv_depth.data(), *mask = view.depth_mask.data();
    known.clear();
    for (int64_t i = 0; i < view.inv_depth.count(); ++i) {
      if (mask[i] > 0 && inv_depth[i] > 0) known.push_back(inv_depth[i]);
    }
    if (!known.empty()) medians.push_back(UpperMedian(&known));
  }
  return medians.empty() ? 0 : 1 / static_cast<double>(UpperMedian(&medians));
}

}  // namespace oraclegs
