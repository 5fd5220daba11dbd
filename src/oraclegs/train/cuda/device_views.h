#pragma once
// The views of a run in a GPU's memory.

#include <cstdint>
#include <vector>

#include "oraclegs/core/buffer.h"
#include "oraclegs/loss/cuda/device_image.h"
#include "oraclegs/train/cuda/outliers.h"
#include "oraclegs/train/loss_terms.h"

namespace oraclegs::cuda {

/// An image as floats, or, where these hold it exactly, as bytes that stand for byte / 255. At most one of the two is
/// defined; neither = no image.
struct PackedImage {
  Buffer<float> floats;
  Buffer<uint8_t> bytes;

  bool defined() const { return floats.defined() || bytes.defined(); }
  /// Bytes of memory that it takes.
  int64_t size_in_bytes() const { return floats.bytes() + bytes.bytes(); }
  PackedImage To(Device device) const { return {floats.To(device), bytes.To(device)}; }
};

/// Packs an image on the host, of any shape: as bytes when each value is byte / 255 to the bit, as in an image file
/// that was not resized; else as the image itself.
PackedImage Packed(const Buffer<float>& image);

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
