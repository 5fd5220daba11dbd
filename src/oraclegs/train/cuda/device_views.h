#pragma once
// The views of a run in a GPU's memory.

#include <vector>

#include "oraclegs/loss/cuda/device_image.h"
#include "oraclegs/train/cuda/floaters.h"
#include "oraclegs/train/loss_terms.h"
#include "oraclegs/train/packed_image.h"

namespace oraclegs::cuda {

/// A view's planes, as bytes where bytes hold them exactly.
struct PackedView {
  PackedImage image, confidence, inv_depth, depth_mask, alpha;  ///< as TrainView's
  Buffer<float>
      lpips_target;  ///< the image in floats, one object for all iterations: the network's cache knows it by it

  int64_t bytes() const;
  PackedView To(Device device) const;
  DeviceImage Plane(ViewPlane plane) const;
};

/// All views of a plan, packed.
class DeviceViews {
 public:
  /// Packs the plan's views, on the CPU.
  explicit DeviceViews(const LossPlan& plan);
  void MoveTo(Device device);

  const PackedView& At(const SampledView& view) const;
  /// The photos that have depth, with the planes that lie on the device.
  std::vector<DepthView> DepthViews(const std::vector<TrainView>& photos) const;
  int64_t bytes() const;

 private:
  std::vector<PackedView> groups_[2];  // by kind
};

/// Maximum over the views of the pixels and of the tiles of the photometric loss.
struct LargestView {
  int64_t pixels = 0, tiles = 0;
};
LargestView LargestOf(const LossPlan& plan);

}  // namespace oraclegs::cuda
