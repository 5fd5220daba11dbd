#pragma once
// Which planes go on where an image has no depth: on lawns, plain walls, and what no other image shows
// (docs/method.md#plane-extrapolation).

#include <optional>
#include <vector>

#include "oraclegs/core/function_ref.h"
#include "oraclegs/depth/depth_map.h"
#include "oraclegs/depth/plane.h"
#include "oraclegs/image/image.h"

namespace oraclegs {

/// The image is cut into square cells. A cell with pixels of unknown depth continues the plane on which most known
/// pixels around it lie, each counted by how much its color is that of the cell: a lawn continues the lawn and not the
/// wall behind it.
class ContinuedPlanes {
 public:
  /// Inverse depth over an image; linear, as that of a plane in space is.
  struct ImagePlane {
    double at_origin = 0, per_x = 0, per_y = 0;

    float At(double x, double y) const { return static_cast<float>(at_origin + per_x * x + per_y * y); }
  };

  /// `rgb` is the map's image. Pixels of at least `min_confidence` are known; `may_fill(index)` says of the others
  /// whether a plane may go on there. The same for any number of threads.
  ContinuedPlanes(const DepthMap& map, const ImageF& rgb, float min_confidence, FunctionRef<bool(size_t)> may_fill);

  /// The plane at a pixel's center; nothing where the pixels around do not agree, too few of them have its color, or
  /// the plane leaves twice the range of known depths.
  std::optional<Plane> At(int x, int y) const;

 private:
  std::vector<std::optional<ImagePlane>> planes_;  // of the cells, row by row
  int cell_ = 1, across_ = 0;                      // pixels; cells
  float nearest_ = 0, farthest_ = 0;               // inverse depth
};

}  // namespace oraclegs
