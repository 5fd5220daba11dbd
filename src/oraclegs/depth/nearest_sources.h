#pragma once
// Which few of many views say the most about a place: where all of them would be asked, work would grow with the square
// of their number.

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "oraclegs/camera/camera.h"
#include "oraclegs/core/function_ref.h"
#include "oraclegs/depth/depth_map.h"

namespace oraclegs {

class NearestSources {
 public:
  NearestSources() = default;
  /// The views of these maps; an empty one has no depth.
  explicit NearestSources(const std::vector<DepthMap>& maps);

  /// Adds the next view, which has depth. `inv_depth` of a pixel (row by row): 1/z, 0 = unknown.
  void Add(const Camera& camera, FunctionRef<float(size_t)> inv_depth);
  /// Adds a next view, which has none.
  void AddNone() { sources_.emplace_back(); }

  /// Indices of at most `most` views that have depth, ascending, without `but`: those of whose surfaces `to` has the
  /// most in frame, seen from near its own direction. All that have depth where there are no more than that.
  std::vector<size_t> For(const Camera& to, size_t most, std::optional<size_t> but = {}) const;

 private:
  struct Source {
    bool has_depth = false;
    Eigen::Vector3d center;
    std::vector<Eigen::Vector3d> points;  ///< of a grid of its pixels, world
  };

  static double Score(const Source& source, const Camera& to);

  std::vector<Source> sources_;
};

}  // namespace oraclegs
