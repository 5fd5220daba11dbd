#include "oraclegs/train/cuda/device_views.h"

#include <algorithm>
#include <atomic>

#include "oraclegs/core/parallel.h"
#include "oraclegs/loss/cuda/photometric.h"

namespace oraclegs::cuda {
namespace {

constexpr int64_t kPackGrain = 1 << 16;  // values a task
constexpr ViewKind kKinds[] = {ViewKind::kPhoto, ViewKind::kProposal};

PackedView Pack(const TrainView& view) {
  // Depth and alpha are compared to the last bit; bytes would seldom hold them exactly.
  const auto packed = [](const Buffer<float>& floats, const Buffer<uint8_t>& bytes) {
    return bytes.defined() ? PackedImage{{}, bytes} : Packed(floats);
  };
  return {packed(view.image, view.image_bytes),
          packed(view.pixel_weight, view.weight_bytes),
          {view.inv_depth, {}},
          Packed(view.depth_mask),
          {view.alpha, {}},
          {}};
}

DeviceImage ImageOf(const PackedImage& image) {
  if (image.bytes.defined()) return {image.bytes.data(), true};
  return {image.floats.data(), false};
}

DepthView ToDepthView(const Camera& camera, const PackedView& planes) {
  DepthView view{};
  const Eigen::Matrix4d pose = camera.cam_from_world.matrix();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) view.cam_from_world[4 * row + column] = pose(row, column);
  }
  view.fx = camera.fx, view.fy = camera.fy, view.cx = camera.cx, view.cy = camera.cy;
  view.width = camera.width, view.height = camera.height;
  view.inv_depth = planes.inv_depth.floats.data();
  view.depth_mask = ImageOf(planes.depth_mask);
  return view;
}

}  // namespace

PackedImage Packed(const Buffer<float>& image) {
  if (!image.defined()) return {};
  const Buffer<uint8_t> bytes = Buffer<uint8_t>::Empty(image.shape());
  const float* from = image.data();
  uint8_t* to = bytes.data();
  std::atomic<bool> exact = true;
  ParallelBlocks(image.count(), kPackGrain, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end && exact; ++i) {
      const bool in_range = from[i] >= 0 && from[i] <= 1;
      to[i] = in_range ? static_cast<uint8_t>(from[i] * 255 + 0.5f) : 0;
      if (!in_range || static_cast<float>(to[i]) / 255 != from[i]) exact = false;
    }
  });
  if (exact) return {{}, bytes};
  return {image, {}};
}

int64_t PackedView::bytes() const {
  int64_t sum = lpips_target.bytes();
  for (const PackedImage* plane : {&image, &confidence, &inv_depth, &depth_mask, &alpha}) sum += plane->size_in_bytes();
  return sum;
}

PackedView PackedView::To(Device device) const {
  return {image.To(device),      confidence.To(device), inv_depth.To(device),
          depth_mask.To(device), alpha.To(device),      lpips_target.To(device)};
}

DeviceImage PackedView::Plane(ViewPlane plane) const {
  switch (plane) {
    case ViewPlane::kImage:
      return ImageOf(image);
    case ViewPlane::kPixelWeight:
      return ImageOf(confidence);
    case ViewPlane::kInvDepth:
      return ImageOf(inv_depth);
    case ViewPlane::kDepthMask:
      return ImageOf(depth_mask);
    case ViewPlane::kAlpha:
      return ImageOf(alpha);
    case ViewPlane::kNone:
      break;
  }
  return {};
}

DeviceViews::DeviceViews(const LossPlan& plan) {
  for (const ViewKind kind : kKinds) {
    for (const TrainView& view : plan.Views(kind)) {
      PackedView packed = Pack(view);
      if (kind == ViewKind::kProposal && plan.has_lpips()) packed.lpips_target = view.image;
      groups_[static_cast<int>(kind)].push_back(std::move(packed));
    }
  }
}

void DeviceViews::MoveTo(Device device) {
  for (auto& group : groups_) {
    for (PackedView& view : group) view = view.To(device);
  }
}

const PackedView& DeviceViews::At(const SampledView& view) const {
  return groups_[static_cast<int>(view.kind)][static_cast<size_t>(view.index)];
}

std::vector<DepthView> DeviceViews::DepthViews(const std::vector<TrainView>& photos) const {
  std::vector<DepthView> views;
  for (size_t i = 0; i < photos.size(); ++i) {
    const PackedView& planes = groups_[static_cast<int>(ViewKind::kPhoto)][i];
    if (planes.inv_depth.defined()) views.push_back(ToDepthView(photos[i].camera, planes));
  }
  return views;
}

int64_t DeviceViews::bytes() const {
  int64_t sum = 0;
  for (const auto& group : groups_) {
    for (const PackedView& view : group) sum += view.bytes();
  }
  return sum;
}

LargestView LargestOf(const LossPlan& plan) {
  LargestView largest;
  for (const ViewKind kind : kKinds) {
    for (const TrainView& view : plan.Views(kind)) {
      largest.pixels = std::max(largest.pixels, int64_t{view.camera.width} * view.camera.height);
      largest.tiles = std::max(largest.tiles, PhotometricTiles(view.camera.width, view.camera.height));
    }
  }
  return largest;
}

}  // namespace oraclegs::cuda
