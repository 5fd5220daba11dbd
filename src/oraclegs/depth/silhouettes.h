#pragma once

#include <cstdint>
#include <vector>

#include "oraclegs/depth/silhouette_mask.h"
#include "oraclegs/scene/loaded_view.h"

namespace oraclegs {

/// Where an object stands in each photograph; nothing of the scene projects beside all of them.
class Silhouettes {
 public:
  /// Recognises an object before a known background, or holds nothing: every photograph's border must, but for a tenth,
  /// be excluded by its mask (unless all have the same) or show one colour, the same in all photographs (a Blender
  /// scene composited on its background; a turntable before a sheet). Background is then what is masked or is that
  /// colour and connected with the border.
  explicit Silhouettes(const std::vector<LoadedView>& photos);

  bool empty() const { return object_.empty(); }
  /// height * width of view `v`'s picture: 1 = object.
  const std::vector<uint8_t>& Object(size_t v) const { return object_[v]; }
  /// False when the pixel of view `v` is farther than two pixels from the object; true beyond the picture, of which
  /// nothing is known.
  bool MayContain(size_t v, float x, float y) const { return Mask(v).MayContain(x, y); }
  /// The same in plain numbers; valid as long as this.
  SilhouetteMask Mask(size_t v) const { return {grown_[v].data(), sizes_[v].first, sizes_[v].second}; }

 private:
  std::vector<std::vector<uint8_t>> object_, grown_;
  std::vector<std::pair<int, int>> sizes_;
};

}  // namespace oraclegs
