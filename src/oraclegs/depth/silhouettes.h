#pragma once

#include <cstdint>
#include <vector>

#include "oraclegs/depth/silhouette_mask.h"
#include "oraclegs/scene/loaded_view.h"

namespace oraclegs {

/// Silhouette of an object in each view (docs/method.md#stereo). The whole scene projects into them.
class Silhouettes {
 public:
  /// Recognizes an object before a known background, or holds nothing: nine tenths of every image's border must be
  /// excluded by its mask (unless all images have the same one) or show one color, the same in all images (a Blender
  /// scene composited on its background; a turntable before a sheet). Background is then the masked region, or the
  /// region of that color connected with the border.
  explicit Silhouettes(const std::vector<LoadedView>& views);

  bool empty() const { return object_.empty(); }
  /// Object pixels of view `v`'s image, height * width: 1 = object.
  const std::vector<uint8_t>& Object(size_t v) const { return object_[v]; }
  /// Whether the object may be at a pixel of view `v`: false more than two pixels from it; true outside the image,
  /// where nothing is known.
  bool MayContain(size_t v, float x, float y) const { return Mask(v).MayContain(x, y); }
  /// The region of MayContain for device code; valid as long as this object.
  SilhouetteMask Mask(size_t v) const { return {grown_[v].data(), sizes_[v].first, sizes_[v].second}; }

 private:
  std::vector<std::vector<uint8_t>> object_, grown_;
  std::vector<std::pair<int, int>> sizes_;
};

}  // namespace oraclegs
