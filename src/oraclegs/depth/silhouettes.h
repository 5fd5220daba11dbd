#pragma once

#include <cstdint>
#include <vector>

#include "oraclegs/depth/silhouette_mask.h"
#include "oraclegs/scene/loaded_view.h"

namespace oraclegs {

/// Where an object is in each view (docs/method.md#stereo). All of the scene projects within them.
class Silhouettes {
 public:
  /// Recognizes an object before a known background, or holds nothing: nine tenths of every image's border must be
  /// excluded by its mask (unless all have the same) or show one color, the same in all images (a Blender scene
  /// composited on its background; a turntable before a sheet). Background is then what is masked, or has that color
  /// and is connected with the border.
  explicit Silhouettes(const std::vector<LoadedView>& views);

  bool empty() const { return object_.empty(); }
  /// height * width of view `v`'s image: 1 = object.
  const std::vector<uint8_t>& Object(size_t v) const { return object_[v]; }
  /// False when the pixel of view `v` is farther than two pixels from the object; true beyond the image, where
  /// nothing is known.
  bool MayContain(size_t v, float x, float y) const { return Mask(v).MayContain(x, y); }
  /// The same for device code; valid as long as this object.
  SilhouetteMask Mask(size_t v) const { return {grown_[v].data(), sizes_[v].first, sizes_[v].second}; }

 private:
  std::vector<std::vector<uint8_t>> object_, grown_;
  std::vector<std::pair<int, int>> sizes_;
};

}  // namespace oraclegs
